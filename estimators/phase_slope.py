"""Full-band phase slope (paper A)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from estimators.estimate import DelayEstimate
from estimators.peak import Index, first_from_zero, strongest
from estimators.search import describe, search_peaks, search_range
from estimators.windows import FixedWindow, WindowPolicy
from sim import EchoPair, checks
from sim.band import Real

PEAKS: Mapping[str, Callable[[Real], Index]] = MappingProxyType({"first": first_from_zero, "strongest": strongest})


@dataclass(frozen=True)
class FullBandPhaseSlope:
    """Delay that maximises the phase-corrected interferogram of the full band, at full resolution.

    Paper A sums the frequential cross-correlation matrix of a pixel against a phase slope (equations 15 to 18). That
    sum is `A(t, tau) = p*(t - tau/2) s(t + tau/2)`, which is what is maximised here, and over a window the sum of it.
    The delay is the first local maximum on a climb from zero delay, as in the paper, or the strongest within the
    search range.

    Parameters
    ----------
    window
        What to average over, or the policy that says it for a pair; a single pixel as in the paper by default.
    peak
        "first" or "strongest".
    refine
        Whether the residual phase refines the delay.
    search
        Largest delay to look for [s]; `2 / B` where None. A peak on its border is not valid.
    lags_per_resolution
        Lags in `1 / B`, at least 4. A coarse climb oversteps narrow ridges: at true delay zero without noise it stays
        on the right one for .762 of single pixels with 8 lags, for .773 with 32, and for .775 in the limit.
    """

    window: WindowPolicy = field(default_factory=lambda: FixedWindow(1, 1))
    peak: Literal["first", "strongest"] = "first"
    refine: bool = True
    search: float | None = None
    lags_per_resolution: int = 32

    def __post_init__(self) -> None:
        checks.count("lags_per_resolution", self.lags_per_resolution, least=4)
        if self.peak not in PEAKS:
            raise ValueError(f"peak is {self.peak!r}; it must be one of {', '.join(PEAKS)}")

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where window or search range exceed the pair."""
        window = self.window.on(pair)
        search = search_range(pair, self.search, 2.0)
        peak = search_peaks(pair, window, search, self.lags_per_resolution, PEAKS[self.peak], self.refine)
        return describe(pair, window, peak, refine=self.refine, search=search)
