"""Two windows: the wrap from a large one, the phase from a small one."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from estimators.estimate import DelayEstimate, Estimator
from estimators.search import describe, read_at
from estimators.uncertainty import small_window_std
from estimators.windows import FixedWindow, WindowPolicy
from sim import EchoPair, checks
from sim.band import Real


@dataclass(frozen=True)
class TwoWindow:
    """Delay nearest to that of another estimator which the phase of a small window allows.

    The wrap needs many looks, the phase few: with the other estimator's delay `tau` the small window's lag product
    `C(t, tau) = sum over the window of p*(t' - tau/2) s(t' + tau/2)` is read at `tau`, where the echoes of both
    receivers meet, not at zero lag, and its phase gives `tau + wrap(-arg C - 2 pi fc tau) / (2 pi fc)`, never more
    than half a wrap from `tau`. An error of `tau` turns that phase only where the speckle's instantaneous frequency is
    off centre; read again at the delay found, dark pixels, where it is far off, would do worse. (Combining neighbours
    for the wrap alone is what paper A leaves as future work.)

    Wrap-error probability and quality are those that the other estimator claims. The predicted spread is that of
    the small window's phase, given how bright it is; its own coherence tells little of it, and nothing for a single
    pixel, so that the coherence of the other estimator's window is taken where it has a larger one (an attribute
    `window`). Valid is what both windows find valid.

    Parameters
    ----------
    wrap
        What resolves the wrap: any estimator.
    phase
        The window that gives the phase; a single pixel by default.
    lags_per_resolution
        Lags in `1 / B` between which the lag product is interpolated, at least 4.

    Raises
    ------
    ValueError
        For fewer lags, and what is no estimator.
    """

    wrap: Estimator
    phase: WindowPolicy = field(default_factory=lambda: FixedWindow(1, 1))
    lags_per_resolution: int = 8

    def __post_init__(self) -> None:
        if not isinstance(self.wrap, Estimator):
            raise ValueError(f"wrap is {self.wrap!r}; it must be an estimator, with a method estimate(pair)")
        checks.count("lags_per_resolution", self.lags_per_resolution, least=4)

    @property
    def window(self) -> WindowPolicy:
        """That of the phase: what neighbours' errors within the wrap share."""
        return self.phase

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where a window or search range exceeds the pair."""
        wide, phase = self.wrap.estimate(pair), self.phase.on(pair)
        within = _readable(wide.delay, pair)
        near = np.where(within, wide.delay, 0.0)
        peak = read_at(pair, phase, near, self.lags_per_resolution)
        narrow = describe(pair, phase, peak, refine=True, search=0.5 / pair.centre_frequency)
        std = small_window_std(pair, peak, phase, phase, narrow.debiased_coherence)
        around = getattr(self.wrap, "window", None)
        if isinstance(around, WindowPolicy):
            larger = around.on(pair)
            by_wide = np.asarray(larger.looks(pair)) > phase.looks(pair)
            std = np.where(by_wide, small_window_std(pair, peak, phase, larger, wide.debiased_coherence), std)
        return replace(
            narrow,
            delay_std=std,
            wrap_error_probability=wide.wrap_error_probability,
            quality=wide.quality,
            valid=wide.valid & narrow.valid & within,
        )


def _readable(delay: Real, pair: EchoPair) -> NDArray[np.bool_]:
    """Where a delay is a number within half the record."""
    readable: NDArray[np.bool_] = np.abs(delay) <= pair.grid.period / 2
    return readable
