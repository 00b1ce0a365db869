"""Ziv-Zakai lower bound of the delay, which counts wrap errors and the prior's width."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator
from scipy.special import erfcx

from .band_lines import MAX_LINES, band_lines
from .coherent_pair import pair_probability
from .conventions import MOST_LOOKS, Floats, positive, signal_strength, within
from .crlb import coherent_delay_crlb

Integers = NDArray[np.int64]

CHUNK = 32
PER_PERIOD = 40
MAIN_LOBE = 128
FLANK = 24
FEW_LOOKS = 6
NEGLIGIBLE = 1e-7
# The pair probability to about 1e-5.
STEP = 0.5
REACH = 12.0


def ziv_zakai_delay_std(
    looks: ArrayLike,
    coherence: ArrayLike,
    centre_frequency: ArrayLike,
    bandwidth: ArrayLike,
    prior_width: ArrayLike,
) -> Floats:
    """
    Ziv-Zakai bound of the delay's RMS error [s], for a uniform prior of `prior_width` T [s].

    `MSE >= int_0^T h V{(1 - h / T) P(h)} dh`: P the coherent pair at lag h, V valley filling (Bell et
    al. 1997). The N lines repeat after `N / B`: a wider prior counts their ambiguity too.

    Relative error below 1e-3 (7e-4 at worst against dense lags, at looks of 1 to 1e6, coherence of 1e-6 to
    1 - 1e-12, `B / fc` of 1e-4 to 1.9). Where wraps are rare it is the coherent Cramer-Rao bound times about
    `1 - 1.06 sigma / T`, for the finite prior.

    Parameters
    ----------
    looks, coherence
        As for `wrap_error_probability`.
    centre_frequency, bandwidth, prior_width
        `fc` and B [Hz], and T [s].

    Returns
    -------
    ndarray
        In seconds; of the broadcast shape.

    Raises
    ------
    ValueError
        For a frequency or prior that is not finite and positive, and a bandwidth of `2 fc` or more.
    """
    fc = positive("centre_frequency", centre_frequency, "Hz")
    b = positive("bandwidth", bandwidth, "Hz")
    width = positive("prior_width", prior_width, "s")
    if np.any(b >= 2.0 * fc):
        raise ValueError(f"bandwidth is {np.max(b / fc):g} of the centre frequency; it must be below 2")
    n, gamma, ratio, periods = np.broadcast_arrays(
        within(looks, 1.0, MOST_LOOKS), within(coherence, 0.0, 1.0), b / fc, width * fc
    )
    result = np.array(0.0 * (n + gamma))
    spread = (result == 0.0) & ((gamma < 1.0) | (n == 1.0))
    for group in (spread & (n <= FEW_LOOKS), spread & (n > FEW_LOOKS)):
        left = np.flatnonzero(group)
        for some in np.array_split(left, -(-left.size // CHUNK)) if left.size else []:
            lags = _Lags(n.flat[some], gamma.flat[some], ratio.flat[some], periods.flat[some])
            result.flat[some] = _std_in_wraps(lags)
    return result / fc


class _Lags:
    """Probabilities at flat lists of (element, lag), in units of the carrier period."""

    def __init__(self, looks: Floats, gamma: Floats, ratio: Floats, prior: Floats) -> None:
        position, self.shapes = band_lines(looks, MAX_LINES + int(3.0 * np.max(ratio * prior)))
        self.frequency = 1.0 + ratio[:, None] * position
        self.q = signal_strength(gamma)
        self.prior = prior
        self.scale = np.clip(coherent_delay_crlb(looks, gamma, 1.0, ratio), 1e-12, 0.25)
        self.few = bool(np.max(looks) <= FEW_LOOKS)

    def _sine2(self, element: Integers, lag: Floats) -> Floats:
        turns = lag[..., None] * self.frequency[element]
        sine: Floats = np.sin(np.pi * (turns - np.rint(turns)))
        return sine**2

    def distance(self, element: Integers, lag: Floats) -> Floats:
        """What makes P small: it is at most `exp(-distance) / 2`."""
        x = self.q[element][..., None] * self._sine2(element, lag)
        total: Floats = np.sum(self.shapes[element] * np.log1p(x), axis=-1)
        return total

    def rarity(self, element: Integers, lag: Floats) -> Floats:
        """About `-log((1 - h / T) 2 P(h))`, with the first term of Lugannani and Rice for P."""
        d = self.distance(element, lag)
        left = np.maximum(1.0 - lag / self.prior[element], 1e-300)
        result: Floats = d - np.log(erfcx(np.sqrt(d))) - np.log(left)
        return result

    def matters(self, element: Integers, lag: Floats, distance: Floats) -> NDArray[np.bool_]:
        """Whether P at this lag can add to the bound."""
        result: NDArray[np.bool_] = lag**2 * np.exp(-distance) > NEGLIGIBLE * self.scale[element] ** 2
        return result

    def filled(self, element: Integers, lag: Floats) -> Floats:
        """`(1 - h / T) P(h)`, before its valleys are filled."""
        d = self.distance(element, lag)
        p = 0.5 * np.exp(-d)
        some = self.matters(element, lag, d)
        who = element[some]
        p[some] = pair_probability(self._sine2(who, lag[some]), self.shapes[who], self.q[who], STEP, REACH)
        return (1.0 - lag / self.prior[element]) * p


def _std_in_wraps(lags: _Lags) -> Floats:
    """The bound in units of one carrier period."""
    count = lags.prior.size
    every = np.arange(count)
    element, peak = _confusable_lags(lags)
    span = np.arcsinh(0.5 / lags.scale)[:, None]
    main = lags.scale[:, None] * np.sinh(span * np.linspace(0.0, 1.0, MAIN_LOBE))
    # Few looks make blunt or uneven tops, of which the highest point is not known beforehand.
    sides = np.linspace(-1.0, 1.0, 4 * FLANK + 1) if lags.few else np.linspace(0.0, 1.0, FLANK)
    flank = (lags.scale[:, None] * np.sinh(span * sides))[element]
    steps = np.linspace(0.5, 1.0, int(PER_PERIOD * np.max(lags.prior)) // 8 + 2) * lags.prior[:, None]
    who = np.concatenate(
        [np.repeat(every, MAIN_LOBE), np.repeat(element, sides.size), np.repeat(every, steps.shape[1])]
    )
    h = np.concatenate([main.ravel(), (peak[:, None] + flank).ravel(), steps.ravel()])
    h = np.clip(h, 0.0, lags.prior[who])
    order = np.lexsort((h, who))
    who, h = who[order], h[order]
    value = lags.filled(who, h)
    ends = np.searchsorted(who, np.arange(count + 1))
    return np.array([_root_moment(h[i:j], value[i:j]) for i, j in pairwise(ends)])


def _root_moment(h: Floats, value: Floats) -> float:
    """Root of the integral of `h V(h)`: V between lags by monotone cubics, and each step by Simpson's rule."""
    apart = np.diff(h, append=np.inf) > 0.0
    h, value = h[apart], value[apart]
    filled = np.maximum.accumulate(value[::-1])[::-1]
    middle = 0.5 * (h[:-1] + h[1:])
    ends = h * filled
    with np.errstate(over="ignore"):
        between = PchipInterpolator(h, filled)(middle)
    steps = ends[:-1] + 4.0 * middle * between + ends[1:]
    return float(np.sqrt(np.sum(np.diff(h) * steps) / 6.0))


def _confusable_lags(lags: _Lags) -> tuple[Integers, Floats]:
    """Elements and lags of the wrong delays that are easiest to mistake, beside zero."""
    prior = lags.prior[:, None]
    grid = np.linspace(0.0, 1.0, int(PER_PERIOD * np.max(prior)) + PER_PERIOD) * prior
    if lags.few:
        # Strong lines alone are blind at their own periods, over widths that no even grid finds.
        turns = np.arange(1.0, 2.0 * np.max(prior) + 1.0)
        own = (turns[:, None] / lags.frequency[:, None, :]).reshape(prior.size, -1)
        grid = np.sort(np.concatenate([grid, np.minimum(own, prior)], axis=1), axis=1)
    d = lags.rarity(np.broadcast_to(np.arange(prior.size)[:, None], grid.shape), grid)
    at, column = np.nonzero((d[:, 1:-1] < d[:, :-2]) & (d[:, 1:-1] <= d[:, 2:]))
    peak = grid[at, column + 1]
    reach = np.maximum(peak - grid[at, column], grid[at, column + 2] - peak)
    # To a twentieth of the narrowest top.
    for _ in range(max(3, int(np.ceil(np.log(0.5 / np.min(lags.scale)) / np.log(6.0))))):
        trial = peak[:, None] + reach[:, None] * np.linspace(-1.0, 1.0, 13)
        best = np.argmin(lags.rarity(np.broadcast_to(at[:, None], trial.shape), trial), axis=1)[:, None]
        peak = np.take_along_axis(trial, best, axis=1)[:, 0]
        reach = reach / 6.0
    some = lags.matters(at, peak, lags.distance(at, peak))
    return at[some], peak[some]
