"""Methods: arrays in, delay estimates out; windows and bounds."""

from estimators import bounds, conformance, quality
from estimators.cross_correlation import CrossCorrelation
from estimators.depth import DepthMap, depth_map
from estimators.estimate import DelayEstimate, Estimator
from estimators.height import Height
from estimators.in_pieces import CrossCorrelationInPieces
from estimators.interferogram import Interferogram
from estimators.maximum_likelihood import MaximumLikelihood
from estimators.multi_chromatic import MultiChromatic
from estimators.neighbours import CombinedNeighbours
from estimators.phase_slope import FullBandPhaseSlope
from estimators.pixels import Pixels
from estimators.range_coherence import KnownCoherence, MeasuredCoherence, ModelledCoherence
from estimators.split_spectrum import SplitSpectrum
from estimators.two_window import TwoWindow
from estimators.validity import Coverage, Thresholds, coverage, valid_range
from estimators.window_policies import AdaptiveWindow, ConstantStdWindow, WrapSafeWindow
from estimators.windows import FixedWindow, VaryingWindow, WindowPolicy

__all__ = [
    "AdaptiveWindow",
    "CombinedNeighbours",
    "ConstantStdWindow",
    "Coverage",
    "CrossCorrelation",
    "CrossCorrelationInPieces",
    "DelayEstimate",
    "DepthMap",
    "Estimator",
    "FixedWindow",
    "FullBandPhaseSlope",
    "Height",
    "Interferogram",
    "KnownCoherence",
    "MaximumLikelihood",
    "MeasuredCoherence",
    "ModelledCoherence",
    "MultiChromatic",
    "Pixels",
    "SplitSpectrum",
    "Thresholds",
    "TwoWindow",
    "VaryingWindow",
    "WindowPolicy",
    "WrapSafeWindow",
    "bounds",
    "conformance",
    "coverage",
    "depth_map",
    "quality",
    "valid_range",
]
