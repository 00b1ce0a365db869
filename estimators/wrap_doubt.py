"""How likely a delay lies in a wrong wrap, given the correlation at the rival wraps."""

from functools import lru_cache

import numpy as np

from estimators.lag_product import LagStack
from estimators.posterior import Looks
from estimators.wrap_doubt_kernels import NODES, Model, Times, doubts
from sim.band import Real


def wrap_doubt(
    stack: LagStack, delay: Real, looks: Looks, centre_frequency: float, search: float, height: Real | None = None
) -> Real:
    """Probability that a delay is in a wrong wrap, given the windowed lag products about it.

    The wraps `m / fc` from it within the search range compete. With the height `c_m` of the passband correlation's peak
    in each, its share of the likelihood is

        M(c) = [1 + 2F1(N - 1, 1/2; 1; c^2)] / 2
             = 1/2 + (1 - c^2)^(3/2 - N) / (2 pi) int_0^pi (1 - c^2 sin^2 a)^(N - 2) da,

    the mean of `(1 - c^2 cos^2)^-(N - 1)` over the half of a wrap where the cosine is positive, and of 1 over the
    other; at the ends of the range, times the part of the wrap that is within. That is the likelihood of a delay of
    circular Gaussian series, their scales and their coherence integrated out: that of gamma, which goes as
    `(1 - gamma^2)^N (1 - gamma c)^(1/2 - 2N)`, with a prior flat in `asin(gamma)`, by Laplace's method. The exponent
    hangs on that prior: one flat in `atanh(gamma)` gives N - 1/2, as `estimators.posterior` has, and one flat in gamma
    N - 3/2. N - 1 was chosen because with it claimed and found rates agree over many coherences. As the wraps are taken
    to be periods of the carrier, and troughs to be as likely as nothing, it is within .15 of the exact integral at 5
    to 15 looks, mostly .03 above it, and within .05 from 33 looks on, mostly .002.

    The prior is flat in the delay over the range too. So what it says is right over scenes whose coherences are spread
    as that prior, and not at each: of a high one, which the window does not know of itself, it says too much. Over such
    scenes found rates are .98 to 1.06 times those claimed of .01 and more for delays even within half a wrap (study
    `reliability`); for delays even over the whole search they were 1.05 to 1.17 times. Below two looks and near full
    coherence the logarithm of what is tabulated is off by up to .6.

    Parameters
    ----------
    stack
        Lag products, `STENCIL` lags longer than the search range on either side.
    delay
        What an estimator found [s]; broadcasts to (rows, time).
    looks
        Equivalent independent looks in the window, a number or one for each time. Of a single one all wraps are alike.
    centre_frequency
        `fc` [Hz].
    search
        Largest delay that may be the true one [s].
    height
        Normalised height at the delay where that is a peak of the passband correlation; broadcasts likewise. It is read
        at the nearest such peak if None.

    Returns
    -------
    array
        Shape (rows, time).
    """
    shape = np.broadcast_shapes(stack.products.shape[1:], np.shape(delay))
    guess = doubt_of_a_guess(2 * search * centre_frequency)
    if np.max(looks) <= 1:
        return np.full(shape, guess)
    distinct, which = _looks_at(looks, shape[1])
    tables = np.stack([_mass_table(float(n)) for n in distinct])
    found: Real = doubts(
        np.broadcast_to(stack.products, (len(stack.products), *shape)),
        np.broadcast_to(stack.energies, (len(stack.energies), *shape)),
        np.ascontiguousarray(np.broadcast_to(delay, shape)) / stack.step,
        None if height is None else np.ascontiguousarray(np.broadcast_to(height, shape)),
        Model(centre_frequency * stack.step, search / stack.step, distinct, which, tables),
    )
    return np.where(distinct[which] <= 1, guess, found)


def doubt_of_a_guess(wraps: float) -> float:
    """Probability that two delays, both even over a range, are half a wrap or more apart: `1 - (R - 1/4) / R^2`.

    `R` is the range in wraps, about `1 - 1 / R` where it is wide, and 3/4 at the least: the phase of an estimate may
    carry it half a wrap beyond its range.
    """
    widest = max(wraps, 0.75)
    return 1 - (widest - 0.25) / widest**2


def _looks_at(looks: Looks, times: int) -> tuple[Real, Times]:
    """Distinct looks, and which of them stands at each time; a record that is not periodic has been continued."""
    if np.ndim(looks) == 0:
        return np.array([looks]), np.zeros(times, dtype=np.intp)
    return np.unique(np.resize(looks, times), return_inverse=True)


@lru_cache(maxsize=256)
def _mass_table(looks: float) -> Real:
    """Log of `1/pi int_0^pi (1 - c^2 sin^2 a)^(N - 2) da` at `NODES` even steps of c; about `-log(pi N) / 2` at 1."""
    # Even steps over a period: exact for the polynomials that these are nearly.
    count = 64 + 16 * int(np.sqrt(looks))
    sine = np.sin(np.pi * (np.arange(count) + 0.5) / count)
    kept = 1 - (np.linspace(0, 1, NODES)[:, None] * sine) ** 2
    table: Real = np.log(np.mean(kept ** (looks - 2.0), axis=1))
    return table
