"""From coherence and looks to the spread and the wrap errors that an estimate has to expect."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from estimators import bounds
from sim.band import Real

WrapErrors = Callable[[float, Real, float], Real]
"""Probability of a wrap error from looks, coherence and relative bandwidth."""

NODES = 257
"""Coherences at which predictions are tabulated."""


Looks = float | Real
"""Independent looks of a window: a number, or one for each time."""


def debiased_coherence(sample_coherence: Real, looks: Looks) -> Real:
    """Coherence that a sample coherence stands for; a single look, which says nothing, stands for none."""
    if np.ndim(looks) == 0:
        return bounds.debias_coherence(sample_coherence, looks) if looks > 1 else np.zeros_like(sample_coherence)
    # A number of looks by itself costs a fifth of an array of them.
    debiased = np.empty(np.broadcast_shapes(np.shape(sample_coherence), np.shape(looks)))
    of_all = np.broadcast_to(sample_coherence, debiased.shape)
    distinct, which = np.unique(looks, return_inverse=True)
    for number, n in enumerate(distinct.tolist()):
        at = which == number
        debiased[..., at] = debiased_coherence(of_all[..., at], n)
    return debiased


def predicted_std(bound: Real, search: float) -> Real:
    """A bound's standard deviation, at most that of a guess anywhere in `-search` to `search` [s]."""
    std: Real = np.minimum(bound, search / np.sqrt(3))
    return std


def predicted_phase_std(coherence: Real, looks: Looks) -> Real:
    """Standard deviation of a multilook phase [rad], `estimators.bounds.multilook_phase_std` over the coherence."""
    return _interpolated(coherence, looks, _phase_std_table)


def predicted_wrap_errors(
    predict: WrapErrors, coherence: Real, looks: Looks, relative_bandwidth: float, search_wraps: float
) -> Real:
    """Probability of a wrong wrap, at most that of a guess within `search_wraps` wraps on either side.

    Interpolates a prediction, `estimators.bounds.wrap_error_probability` or its like, over the coherence.
    """
    predicted = _interpolated(coherence, looks, lambda n: _wrap_error_table(predict, n, relative_bandwidth))
    guess = max(1 - 1 / (2 * search_wraps), 0.0)
    # Where no prediction holds, at less than a look a sub-band, a guess is all that is left.
    no_more: Real = np.fmin(predicted, guess)
    return no_more


def _interpolated(coherence: Real, looks: Looks, table: Callable[[float], tuple[Real, Real]]) -> Real:
    """Read the table of each distinct number of looks, which stands for one time or for all."""
    if np.ndim(looks) == 0:
        read: Real = np.interp(coherence, *table(float(looks)))
        return read
    distinct, which = np.unique(looks, return_inverse=True)
    read = np.empty(coherence.shape)
    for number, n in enumerate(distinct):
        at = which == number
        read[..., at] = np.interp(coherence[..., at], *table(float(n)))
    return read


@lru_cache(maxsize=256)
def _wrap_error_table(predict: WrapErrors, looks: float, relative_bandwidth: float) -> tuple[Real, Real]:
    nodes = _coherence_nodes()
    return nodes, predict(looks, nodes, relative_bandwidth)


@lru_cache(maxsize=256)
def _phase_std_table(looks: float) -> tuple[Real, Real]:
    nodes = _coherence_nodes()
    return nodes, bounds.multilook_phase_std(looks, nodes)


def _coherence_nodes() -> Real:
    """Even steps in the angle whose sine is the coherence: dense where spread and wrap errors fall fastest."""
    nodes: Real = np.sin(np.linspace(0, np.pi / 2, NODES))
    return nodes
