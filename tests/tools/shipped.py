"""The shipped estimators, each made with a window."""

from estimators import (
    CrossCorrelation,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
)

METHODS = {
    "interferogram": Interferogram,
    "cross-correlation": CrossCorrelation,
    "cross-correlation-group": lambda window: CrossCorrelation(window, refine=False),
    "split-spectrum": SplitSpectrum,
    "multi-chromatic": lambda window: MultiChromatic(window, bands=3),
    "maximum-likelihood": MaximumLikelihood,
    "phase-slope": lambda window: FullBandPhaseSlope(window, lags_per_resolution=8),
    "two-window": lambda window: TwoWindow(CrossCorrelation(window)),
}
