"""An estimator of long records, piece by piece in time, so that what it holds at once does not grow with them."""

from dataclasses import dataclass, fields, replace

import numpy as np

from estimators.cross_correlation import CrossCorrelation
from estimators.estimate import DelayEstimate
from estimators.search import search_range
from estimators.windows import FixedWindow, VaryingWindow, Window
from sim import EchoPair

PIECE = 512
"""Samples of a piece."""

MARGIN = 32
"""Resolution cells beyond the windows at either end of a piece, where its end still tells."""


@dataclass(frozen=True)
class CrossCorrelationInPieces(CrossCorrelation):
    """`CrossCorrelation`, a piece of the record after the other, each with what its windows and the search reach.

    A policy sees the whole record first. Delays differ from those of the whole by what the ends of a piece leave of
    band-limited interpolation; a circular record counts as one that is not, so that windows that reach beyond its ends
    are not valid.
    """

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample; ValueError as of `CrossCorrelation`."""
        window, samples = self.window.on(pair), pair.shape[1]
        search = search_range(pair, self.search, 1.0)
        reach = window.extent[1] + int(np.ceil((search + MARGIN / pair.bandwidth) * pair.sample_rate))
        found = []
        for start in range(0, samples, PIECE):
            stop = min(start + PIECE, samples)
            first, last = max(start - reach, 0), min(stop + reach, samples)
            whole = CrossCorrelation(_part(window, first, last), self.refine, search, self.lags_per_resolution)
            estimate = whole.estimate(_piece(pair, first, last))
            found.append([getattr(estimate, f.name)[:, start - first : stop - first] for f in fields(DelayEstimate)])
        return DelayEstimate(*(np.concatenate(parts, axis=1) for parts in zip(*found, strict=True)))


def _piece(pair: EchoPair, first: int, last: int) -> EchoPair:
    """Some samples of a pair, by themselves."""
    geometry = pair.geometry
    return replace(
        pair,
        primary=pair.primary[:, first:last],
        secondary=pair.secondary[:, first:last],
        truth=None,
        geometry=None if geometry is None else replace(geometry, start=geometry.start + first / pair.sample_rate),
        circular=False,
    )


def _part(window: Window, first: int, last: int) -> Window:
    if isinstance(window, FixedWindow):
        return window
    return VaryingWindow(window.rows[first:last], window.samples[first:last])
