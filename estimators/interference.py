"""Interferogram and coherence of a pair of images: windowed sums at zero delay, straight from the images."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimators.interference_kernel import Scales, interfere
from estimators.lag_product import scale_of

ROWS = 512
"""Least number of rows from one fresh start of the sums to the next."""

Numbers = NDArray[Any]


def interferogram(
    primary: Numbers, secondary: Numbers, rows: int, samples: int, *, circular: bool, threads: int = 1
) -> tuple[Numbers, Numbers]:
    """Windowed `sum conj(p) s` and its coherence `|sum conj(p) s| / sqrt(sum |p|^2 sum |s|^2)`.

    At a cost that does not depend on the size of the window, which is that of `estimators.FixedWindow`. All sums are of
    double precision. Beside a pixel 80 dB brighter the phase errs by some 1e-9. A window whose energy is below what
    rounding may have left there, 3e-12 of the brightest's for 9 x 9 pixels and 1.3e-11 for 39 x 39, counts as empty.

    Parameters
    ----------
    primary, secondary
        complex64 or complex128, shape (rows, time); read where they lie.
    rows, samples
        Size of the window.
    circular
        Whether the images are periodic in time; otherwise nothing lies beyond them.
    threads
        The result does not depend on it.

    Returns
    -------
    product, coherence
        Of the precision of the images and of their shape; 0 where a window is empty.

    Raises
    ------
    ValueError
        For images that are not complex or differ in shape, and for a window of less than a pixel or beyond the period.
    """
    if primary.shape != secondary.shape or primary.ndim != 2:
        raise ValueError(
            f"the images have the shapes {primary.shape} and {secondary.shape}; they must be one (rows, time)"
        )
    if not (np.iscomplexobj(primary) and primary.dtype == secondary.dtype):
        raise ValueError(f"the images are of type {primary.dtype} and {secondary.dtype}; they must be one complex type")
    if min(rows, samples) < 1 or (circular and samples > primary.shape[1]):
        raise ValueError(
            f"the window has {rows} rows and {samples} samples; it must have 1 at least, and fit the period"
        )
    scales = [scale_of(series) for series in (primary, secondary)]
    product = np.empty(primary.shape, primary.dtype)
    # In parts of the brightest, energies of single pixels may be smaller than single precision holds.
    coherence = np.empty(primary.shape, primary.real.dtype if rows * samples > 1 else np.float64)
    # What is of single precision needs none.
    units = (scales[0], scales[1], 1 / scales[0] / scales[1]) if product.dtype == np.complex128 else (None, None, None)
    _by_blocks(primary, secondary, units, (rows, samples), circular, product, None, coherence, threads)
    return product, coherence.astype(primary.real.dtype, copy=False)


def interferogram_with_energy(
    primary: Numbers, secondary: Numbers, rows: int, samples: int, *, circular: bool
) -> tuple[Numbers, Numbers]:
    """Windowed `sum conj(p) s` and `sqrt(sum |p|^2 sum |s|^2)`, as `interferogram`, both on a scale near 1.

    Returns
    -------
    product, energy
        Of double precision, shape (rows, time); (rows, 1) where every window holds the whole period.
    """
    scales = scale_of(primary), scale_of(secondary), None
    times = 1 if circular and samples == primary.shape[1] else primary.shape[1]
    product, energy = np.empty((len(primary), times), np.complex128), np.empty((len(primary), times))
    _by_blocks(primary, secondary, scales, (rows, samples), circular, product, energy, None, 1)
    return product, energy


def _by_blocks(
    primary: Numbers,
    secondary: Numbers,
    scales: Scales,
    sizes: tuple[int, int],
    circular: bool,
    product: Numbers,
    energy: Numbers | None,
    coherence: Numbers | None,
    threads: int,
) -> None:
    # As pairs of real numbers.
    p, s = (np.ascontiguousarray(series).view(series.real.dtype) for series in (primary, secondary))
    out = product.view(product.real.dtype)
    step = max(ROWS, 16 * sizes[0])

    def work(first: int) -> None:
        interfere(p, s, scales, (first, min(first + step, len(p))), sizes, circular, out, energy, coherence)

    firsts = range(0, len(p), step)
    if threads == 1:
        for first in firsts:
            work(first)
    else:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(work, firsts))
