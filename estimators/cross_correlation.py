"""Sliding complex cross-correlation."""

from dataclasses import dataclass

from estimators.estimate import DelayEstimate
from estimators.height import Height
from estimators.peak_kernels import strongest
from estimators.search import describe, search_peaks, search_range
from estimators.windows import WindowPolicy
from sim import EchoPair, checks


@dataclass(frozen=True)
class CrossCorrelation:
    """Delay at which the windowed complex cross-correlation is strongest, refined by its phase.

    `C(t, tau) = sum over the window of p*(t' - tau/2) s(t' + tau/2)`; the delay maximises `|C|`, and the phase of `C`
    there picks the delay within the wrap (paper A, section 1; Sæbø, Synnes and Hansen 2013). With refinement the
    spread is that of the phase, without it that of the group delay. Time grows as samples, rows and lags do, and not
    with the window (`docs/scaling.md`).

    Parameters
    ----------
    window
        What to average over, or the policy that says it for a pair.
    refine
        Whether the residual phase refines the delay.
    search
        Largest delay to look for [s], or a `Height`; `1 / B` where None. A peak on its border is not valid.
    lags_per_resolution
        Lags in `1 / B`, at least 4; more cost more time and gain nothing for windows of many looks.

    Raises
    ------
    ValueError
        For fewer lags; by `estimate`, for a search that is not above 0 s or is beyond half the record.
    """

    window: WindowPolicy
    refine: bool = True
    search: float | Height | None = None
    lags_per_resolution: int = 4

    def __post_init__(self) -> None:
        checks.flag("refine", self.refine)
        checks.count("lags_per_resolution", self.lags_per_resolution, least=4)

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where window or search range exceed the pair."""
        window = self.window.on(pair)
        search = search_range(pair, self.search, 1.0)
        peak = search_peaks(pair, window, search, self.lags_per_resolution, strongest, self.refine)
        return describe(pair, window, peak, refine=self.refine, search=search)
