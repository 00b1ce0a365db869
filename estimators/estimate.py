"""What an estimator is, and what it gives."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sim import EchoPair
from sim.band import Real


@dataclass(frozen=True, eq=False)
class DelayEstimate:
    """Delay of the secondary behind the primary at every sample, and how far it can be trusted.

    All arrays have the shape of the pair, (along_track, time), and are finite where `valid`. They may be read-only.

    Attributes
    ----------
    delay
        Absolute delay [s].
    phase
        Of the lag product at that delay, `2 pi fc delay` modulo `2 pi` where the phase refines the delay [rad], in
        (-pi, pi]. Of maximum likelihood, which finds the passband's peak, it differs from that by some 8 % of its STD.
    coherence
        Sample coherence at that delay, 0 to 1; biased upward, and always 1 for a single look.
    debiased_coherence
        Coherence whose mean sample coherence over as many looks is this one; 0 below the bias floor, and for a single
        look.
    delay_std
        Predicted standard deviation of the delay while the wrap is right [s]: half of the 95 % interval that the window
        leaves it within the wrap (`estimators.posterior`), over 1.96; at most the spread of a guess within the search
        range.
    wrap_error_probability
        Predicted probability that the delay is off by half a wrap or more, given the window's correlation at the rival
        wraps (`estimators.wrap_doubt`). Of searches, over scenes of all coherences and delays within half a wrap, it is
        the rate within some 5 % (study `reliability`); at a single high coherence, which the window does not know, it
        is on average above it.
    quality
        0 (worthless) to 1: the probability that the wrap is right. Of the metrics of `estimators.quality` it tells
        wrong wraps best.
    valid
        Where the window lay inside the record, held an echo and came near no missing sample nor silence, and the search
        ended inside its range.
    """

    delay: Real
    phase: Real
    coherence: Real
    debiased_coherence: Real
    delay_std: Real
    wrap_error_probability: Real
    quality: Real
    valid: NDArray[np.bool_]


@runtime_checkable
class Estimator(Protocol):
    """Anything that turns a pair of echoes into delays."""

    def estimate(self, pair: EchoPair) -> DelayEstimate:
        """Estimate the delay at every sample of a pair."""
