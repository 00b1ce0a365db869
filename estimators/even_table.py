"""Tables over even steps, read on a straight line between neighbours."""

import numpy as np

from sim.band import Real
from sim.compiled import compiled


def read_even(x: Real, places: Real, values: Real, beyond: float | None = None) -> Real:
    """What `np.interp` reads, to rounding, where places are even steps from 0; at a cost that does not depend on `x`.

    A search for the step takes longest where neighbours are least alike, as of the coherence of small windows.

    Parameters
    ----------
    x
        Of any shape, not below 0; NaN reads as NaN.
    places, values
        The table.
    beyond
        What lies beyond its last place; its last value if None.
    """
    flat = np.ascontiguousarray(x, dtype=np.float64).reshape(-1)
    read = np.empty_like(flat)
    last = float(values[-1])
    _read(flat, float(1 / places[1]), values, last if beyond is None else beyond, read)
    return read.reshape(np.shape(x))


@compiled
def _read(x: Real, steps: float, values: Real, beyond: float, read: Real) -> None:
    last = values.size - 1
    for i in range(x.size):
        place = x[i] * steps
        if place < last:
            step = int(max(place, 0.0))
            here = values[step]
            read[i] = here + (place - step) * (values[step + 1] - here)
        elif place == last:
            read[i] = values[last]
        else:
            read[i] = beyond if place > last else place
