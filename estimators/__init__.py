"""Methods: arrays in, delay estimates out; windows and bounds."""

from estimators import bounds, conformance, quality
from estimators.cross_correlation import CrossCorrelation
from estimators.estimate import DelayEstimate, Estimator
from estimators.height import Height
from estimators.interferogram import Interferogram
from estimators.maximum_likelihood import MaximumLikelihood
from estimators.multi_chromatic import MultiChromatic
from estimators.neighbours import CombinedNeighbours
from estimators.phase_slope import FullBandPhaseSlope
from estimators.split_spectrum import SplitSpectrum
from estimators.two_window import TwoWindow
from estimators.windows import FixedWindow

__all__ = [
    "CombinedNeighbours",
    "CrossCorrelation",
    "DelayEstimate",
    "Estimator",
    "FixedWindow",
    "FullBandPhaseSlope",
    "Height",
    "Interferogram",
    "MaximumLikelihood",
    "MultiChromatic",
    "SplitSpectrum",
    "TwoWindow",
    "bounds",
    "conformance",
    "quality",
]
