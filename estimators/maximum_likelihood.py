"""Coherent maximum likelihood: carrier and band together."""

from dataclasses import dataclass, replace

import numpy as np

from estimators.estimate import DelayEstimate
from estimators.height import Height
from estimators.lag_product import LagStack
from estimators.peak import Peak, passband_peak
from estimators.search import describe, over_lags, search_range
from estimators.windows import WindowPolicy
from estimators.wrap_doubt import wrap_doubt
from sim import EchoPair, checks


@dataclass(frozen=True)
class MaximumLikelihood:
    """Delay at which the windowed real passband correlation is highest.

    The delay maximises `Re{exp(2 pi i fc tau) C(t, tau)}` with the windowed lag product
    `C(t, tau) = sum over the window of p*(t' - tau/2) s(t' + tau/2)`: the likelihood of a delay of circular Gaussian
    series with one coherence over the band (Knapp and Carter 1976, with the carrier kept). It tells the wrap as the
    cross-correlation does, and within the wrap it reaches the coherent bound with fewer looks.

    The search visits every wrap, so that its cost grows with `fc / B`. Its peaks are those of the definition within
    1e-5 wraps with four lags in `1 / B`, 3e-8 with eight, and to rounding with 32.

    Parameters
    ----------
    window
        What to average over, or the policy that says it for a pair.
    search
        Largest delay to look for [s], or a `Height`; `1 / B` where None. A peak up to a wrap beyond it that is
        higher than all within is not valid.
    lags_per_resolution
        Lags in `1 / B` between which the correlation is interpolated, at least 4.

    Raises
    ------
    ValueError
        For fewer lags; by `estimate`, for a search that is not above 0 s or is beyond half the record.
    """

    window: WindowPolicy
    search: float | Height | None = None
    lags_per_resolution: int = 4

    def __post_init__(self) -> None:
        checks.count("lags_per_resolution", self.lags_per_resolution, least=4)

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError where window or search range exceed the pair."""
        window = self.window.on(pair)
        search = search_range(pair, self.search, 1.0)
        looks = window.looks(pair)

        def find(stack: LagStack, _: int) -> Peak:
            peak = passband_peak(stack, pair.centre_frequency, pair.bandwidth, search)
            return peak._replace(doubt=wrap_doubt(stack, peak.delay, looks, pair.centre_frequency, search, peak.height))

        peak = over_lags(pair, window, search, self.lags_per_resolution, 2.0, find)
        # The delay stands as found: at the passband peak the phase of the lag product need not be that of the carrier.
        delay = np.broadcast_to(peak.delay, pair.shape)
        return replace(describe(pair, window, peak, refine=True, search=search), delay=delay)
