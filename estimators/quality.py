"""Metrics that tell estimates in the right wrap from outliers: each from 0, worthless, to 1.

Each takes the pair, the estimate that is judged, and the window from which it judges: that of the estimator itself, or
a larger one, in which case neighbours vouch for a pixel.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from estimators.estimate import DelayEstimate
from estimators.lag_product import LagStack, power, scale_of
from estimators.peak import Peak, moved_to
from estimators.search import over_lags, read_at
from estimators.windows import FixedWindow
from sim import EchoPair
from sim.band import Real

LAGS_PER_RESOLUTION = 8

Metric = Callable[[EchoPair, DelayEstimate, FixedWindow], Real]


def brightness(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Real:
    """`I / (I + mean I)` of the power `I` of both series in the window: dark pixels have the most wrong wraps."""
    # A scale of its own for either series, which the share does not show, lets powers neither overflow nor vanish.
    scaled = (np.asarray(x * scale_of(x), dtype=np.complex128) for x in (pair.primary, pair.secondary))
    primary, secondary = (window.sum(power(series)) for series in scaled)
    intensity = np.sqrt(primary) * np.sqrt(secondary)
    mean = float(intensity.mean())
    share = intensity / (intensity + mean) if mean > 0 else np.zeros_like(intensity)
    return np.broadcast_to(share, pair.shape)


def coherence(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Real:
    """Sample coherence of the window at the estimate's delay; of a single look always 1, where there is an echo."""
    height = _read(pair, estimate, window).height
    # What is left of 1 is rounding, which must not rank pixels.
    return np.where(height > 0, 1.0, 0.0) if window.pixels == 1 else height


def likelihood(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Real:
    """Probability that the wrap is right, given the window's correlation there and at its rivals (`wrap_doubt`)."""
    peak = read_at(pair, window, _readable(pair, estimate), LAGS_PER_RESOLUTION, _search(pair))
    return 1 - peak.doubt


def peak_ratio(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Real:
    """One less the height of the second highest peak within `1 / B` over that of the highest; 1 for a single peak."""

    def ratio(stack: LagStack, margin: int) -> Peak:
        inner = power(stack.products[margin:-margin])
        top = (inner[1:-1] > inner[:-2]) & (inner[1:-1] >= inner[2:])
        heights = np.where(top, inner[1:-1], 0.0)
        highest = heights.max(axis=0)
        heights[heights.argmax(axis=0)[None] == np.arange(len(heights)).reshape(-1, 1, 1)] = 0.0
        share = np.sqrt(np.divide(heights.max(axis=0), highest, out=np.ones_like(highest), where=highest > 0))
        return _only(share, stack)

    second = over_lags(pair, window, _search(pair), LAGS_PER_RESOLUTION, 0.0, ratio).delay
    return np.broadcast_to(1 - second, pair.shape)


def curvature(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Real:
    """`k / (k + 1)` of the curvature `k` of the squared magnitude at the delay, in units of a flat band's.

    `k = -(|C|^2)'' / |C|^2 / (2 pi^2 B^2 / 3)`, as that of `sinc^2(B tau)` at zero is `2 pi^2 B^2 / 3`; 0 where it is
    negative.
    """
    delay = _readable(pair, estimate)

    def bend(stack: LagStack, _: int, near: Real) -> Peak:
        unread = Peak(near, stack.products[0], stack.energies[0], np.ones((), dtype=np.bool_))
        step = stack.step
        here, before, after = (power(moved_to(unread, stack, near + d).product) for d in (0.0, -step, step))
        fall = np.divide(2 * here - before - after, here, out=np.zeros_like(here), where=here > 0)
        return _only(np.maximum(fall / step**2 / (2 * np.pi**2 * pair.bandwidth**2 / 3), 0.0), stack)

    k = over_lags(pair, window, float(np.abs(delay).max()), LAGS_PER_RESOLUTION, 1.0, bend, delay).delay
    return k / (k + 1)


def agreement(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Real:
    """Share of the other pixels in the window whose delays lie within half a wrap of this one's; 1 for one alone."""
    delay, limit = estimate.delay, 0.5 / pair.centre_frequency
    rows, samples = (np.arange(n) for n in pair.shape)
    agree, asked = np.zeros(pair.shape), np.zeros(pair.shape)
    for along in range(-(window.rows // 2), window.rows - window.rows // 2):
        for across in range(-(window.samples // 2), window.samples - window.samples // 2):
            if (along, across) == (0, 0):
                continue
            there = _held(rows + along)[:, None] & (_held(samples + across) | pair.circular)
            other = np.roll(delay, (-along, -across), axis=(0, 1))
            agree += there & (np.abs(other - delay) < limit)
            asked += there
    return np.divide(agree, asked, out=np.ones(pair.shape), where=asked > 0)


METRICS: Mapping[str, Metric] = MappingProxyType(
    {metric.__name__: metric for metric in (brightness, peak_ratio, curvature, coherence, agreement, likelihood)}
)
"""All of them by name."""


def roc_area(metric: Real, right: ArrayLike) -> tuple[float, float]:
    """Area under the receiver operating characteristic of a metric, and its standard error for independent pixels.

    The chance that a right estimate has a higher metric than a wrong one, ties counting half (Mann and Whitney); the
    error as of DeLong, DeLong and Clarke-Pearson (1988).

    Parameters
    ----------
    metric
        Any shape.
    right
        Whether each estimate is right, same shape.

    Returns
    -------
    area, error
        NaN where all are right, or none.
    """
    is_right = np.asarray(right, dtype=np.bool_).ravel()
    good, bad = metric.ravel()[is_right], metric.ravel()[~is_right]
    if not (good.size > 1 and bad.size > 1):
        return np.nan, np.nan
    # Share of the wrong ones below each right one, and of the right ones above each wrong one.
    below = _midranks(good, bad) / bad.size
    above = 1 - _midranks(bad, good) / good.size
    variance = below.var(ddof=1) / good.size + above.var(ddof=1) / bad.size
    return float(below.mean()), float(np.sqrt(variance))


def _held(places: NDArray[np.intp]) -> NDArray[np.bool_]:
    held: NDArray[np.bool_] = (places >= 0) & (places < len(places))
    return held


def _midranks(values: Real, among: Real) -> Real:
    """How many of a sample lie below each value, half of those that are equal."""
    ordered = np.sort(among)
    ranks: Real = (np.searchsorted(ordered, values, "left") + np.searchsorted(ordered, values, "right")) / 2
    return ranks


def _search(pair: EchoPair) -> float:
    return min(1 / pair.bandwidth, pair.grid.period / 2)


def _readable(pair: EchoPair, estimate: DelayEstimate) -> Real:
    delay: Real = np.clip(np.nan_to_num(estimate.delay), -pair.grid.period / 2, pair.grid.period / 2)
    return delay


def _read(pair: EchoPair, estimate: DelayEstimate, window: FixedWindow) -> Peak:
    return read_at(pair, window, _readable(pair, estimate), LAGS_PER_RESOLUTION)


def _only(value: Real, stack: LagStack) -> Peak:
    """A number for each pixel, carried as its delay."""
    return Peak(value, stack.products[0], stack.energies[0], np.ones((), dtype=np.bool_)).spread()
