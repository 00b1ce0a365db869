"""From coherence and looks to the spread that an estimate has to expect."""

from functools import lru_cache

import numpy as np

from estimators import bounds
from estimators.estimate import DelayEstimate
from sim import EchoPair
from sim.band import Real

NODES = 257
"""Coherences at which predictions are tabulated."""


def debiased_coherence(sample_coherence: Real, looks: float) -> Real:
    """Coherence that a sample coherence stands for; a single look, which says nothing, stands for none."""
    return np.zeros_like(sample_coherence) if looks <= 1 else bounds.debias_coherence(sample_coherence, looks)


def predicted_std(bound: Real, search: float) -> Real:
    """A bound's standard deviation, at most that of a guess anywhere in `-search` to `search` [s]."""
    std: Real = np.minimum(bound, search / np.sqrt(3))
    return std


def predicted_phase_std(coherence: Real, looks: float) -> Real:
    """Standard deviation of a multilook phase [rad], `estimators.bounds.multilook_phase_std` over the coherence."""
    std: Real = np.interp(coherence, *_phase_std_table(looks))
    return std


def small_window_std(vouched: DelayEstimate, looks: float, pair: EchoPair) -> Real:
    """Standard deviation of the delay [s] from the phase of a few looks, whose coherence a larger window tells."""
    std: Real = predicted_phase_std(vouched.debiased_coherence, looks) / (2 * np.pi * pair.centre_frequency)
    return std


@lru_cache(maxsize=256)
def _phase_std_table(looks: float) -> tuple[Real, Real]:
    nodes = _coherence_nodes()
    return nodes, bounds.multilook_phase_std(looks, nodes)


def _coherence_nodes() -> Real:
    """Even steps in the angle whose sine is the coherence: dense where the spread falls fastest."""
    nodes: Real = np.sin(np.linspace(0, np.pi / 2, NODES))
    return nodes
