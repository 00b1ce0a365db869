"""Neighbours combined to a requested accuracy: what paper A leaves as future work."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from estimators.estimate import DelayEstimate, Estimator
from estimators.phase_slope import FullBandPhaseSlope
from estimators.posterior import Looks
from estimators.windows import FixedWindow, WindowPolicy
from sim import EchoPair, checks
from sim.band import Real

WINDOWS = tuple(FixedWindow(1, samples) for samples in (1, 3, 5, 9, 17, 33, 65, 129))
"""Windows that are tried, the smallest first."""


@dataclass(frozen=True)
class CombinedNeighbours:
    """Mean delay of the smallest window around each pixel whose predicted spread is small enough.

    Delays are weighted by the probability `1 - p` that their wrap is right, so that outliers, which know of themselves,
    hardly count. Of `n` pixels and `L` looks in the window, and `l` looks in the estimator's own, `L / l` are taken to
    be independent, at least one, and less where not all pixels are valid: the mean has the mean variance that they
    claim, times `l / L`. What single pixels
    claim tells the dark from the bright, where of windows it is mostly chance: they are weighted by `(1 - p) / sigma^2`
    instead, for the variance `n l / (L sum w)`.

    The delay is the circular mean of the carrier's phases, in the wrap of the mean delay: of a neighbour in a wrong
    wrap, which the weights leave a little of, the phase is right all the same.

    Its wrap-error probability is the mean of the neighbours'. That of their mean is less where they err apart: of
    windows of 9 samples at a coherence of .95, combined over 65, .028 is claimed and none of 1,500 was wrong.

    A pixel that no window makes accurate enough keeps the mean over the largest, with the spread that it has, and is
    not valid. That errors within the wrap are independent but for what windows share is taken on trust. Those of single
    pixels share a little more: at 15 dB, weighted errors 2 to 6 samples apart have correlations of .08 to .01 where
    noise in the band explains .05 to 0, so that the spread is 1.01 times the one claimed for 33 samples, 1.03 for 65
    and 1.05 for 129; where windows are chosen for what they claim, 1.03 times at .01 wraps asked for, 1.09 at .005 and
    1.13 at .003 (study `neighbours`). Where the seabed is not flat over the window, the mean is of what lies in it.

    Parameters
    ----------
    estimator
        What is combined: any estimator; the refined phase slope of single pixels by default. One without an attribute
        `window` is taken to be of single pixels.
    std
        Requested standard deviation of the delay while the wraps are right [s].
    windows
        Those that are tried, the smallest first.

    Raises
    ------
    ValueError
        For a spread that is not above 0, no windows, and what is no estimator.
    """

    estimator: Estimator = field(default_factory=FullBandPhaseSlope)
    std: float = 1e-7
    windows: Sequence[FixedWindow] = WINDOWS

    def __post_init__(self) -> None:
        checks.positive("std", self.std, "s")
        if not self.windows:
            raise ValueError("windows are empty; there must be one or more")
        if not isinstance(self.estimator, Estimator):
            raise ValueError(f"estimator is {self.estimator!r}; it must have a method estimate(pair)")

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where the pair does not hold the smallest window."""
        single = self.estimator.estimate(pair)
        own = getattr(self.estimator, "window", None)
        looks = own.on(pair).looks(pair) if isinstance(own, WindowPolicy) else 1.0
        fits = [w for w in self.windows if w.rows <= pair.shape[0] and w.samples <= pair.shape[1]] or self.windows[:1]
        combined = _combined(pair, single, fits[0], looks)
        for window in fits[1:]:
            short = combined["delay_std"] > self.std
            if not short.any():
                break
            wider = _combined(pair, single, window, looks)
            combined = {name: np.where(short, wider[name], combined[name]) for name in combined}
        valid = combined.pop("valid") > 0
        phase = np.pi - np.mod(np.pi - 2 * np.pi * pair.centre_frequency * combined["delay"], 2 * np.pi)
        return DelayEstimate(**combined, phase=phase, valid=valid & (combined["delay_std"] <= self.std))


def _combined(pair: EchoPair, single: DelayEstimate, window: FixedWindow, looks: Looks) -> dict[str, Real]:
    """Weighted means over a window, and whether it lies within the pair and holds anything valid."""
    window.check(pair)
    wrap = 1 / pair.centre_frequency
    known = single.valid & np.isfinite(single.delay) & np.isfinite(single.delay_std)
    # In wraps, and none so sure that all others are lost in rounding.
    variance = np.maximum(np.where(known, single.delay_std, wrap) / wrap, 1e-6) ** 2
    trust = np.where(known, np.clip(1 - single.wrap_error_probability, 0.0, 1.0), 0.0)
    single_pixels = bool(np.max(looks) < 2)
    weight = trust / variance if single_pixels else trust
    total = window.sum(weight)

    def mean(of: Real) -> Real:
        summed = window.sum(weight * np.where(known, of, 0.0))
        return np.broadcast_to(np.divide(summed, total, out=np.zeros_like(total), where=total > 0), pair.shape)

    pixels, independent = window.rows * window.samples, window.looks(pair) / looks
    if single_pixels:
        claimed = np.divide(pixels, total, out=np.full_like(total, 1 / 12), where=total > 0)
    else:
        # Of neighbours that are not valid none counts; the weights of single pixels say so themselves.
        independent = independent * window.sum(known.astype(float)) / pixels
        claimed = np.where(total > 0, mean(variance), 1 / 12)
    near = mean(single.delay)
    phasors = window.sum(weight * np.exp(2j * np.pi * np.where(known, single.delay, 0.0) / wrap))
    turns = np.angle(phasors) / (2 * np.pi)
    wrong = np.where(total > 0, mean(single.wrap_error_probability), 1.0)
    return {
        "delay": near + (turns - near / wrap - np.rint(turns - near / wrap)) * wrap,
        "coherence": mean(single.coherence),
        "debiased_coherence": mean(single.debiased_coherence),
        "delay_std": np.broadcast_to(wrap * np.sqrt(claimed / np.maximum(independent, 1.0)), pair.shape),
        "wrap_error_probability": wrong,
        "quality": 1 - wrong,
        "valid": (window.inside(pair) & (total > 0)).astype(float),
    }
