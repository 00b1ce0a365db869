"""What an estimator may take for the truth: the rivals that rare errors come from."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sim import checks
from sim.band import Band, Real


class RareErrors(Protocol):
    """A kind of error, as the rivals of the true delay that it stands for."""

    def turns(self, band: Band, centre_frequency: float) -> Real:
        """Phases by which each rival differs from the truth in each Fourier bin [rad], shape (rival, bin)."""


@dataclass(frozen=True)
class DelayErrors:
    """A delay off by whole wraps, as of a search over delay: cross-correlation, phase slope, maximum likelihood.

    The envelope does not see the phase of a rival. One that is `m` wraps off differs by `2 pi m (f - f0) / fc`, with
    the frequency `f0`, where it agrees with the truth, anywhere in the band. (Few looks of high coherence err where
    a single bin outshines all others: then it is that bin's.)

    Parameters
    ----------
    wraps
        The largest `|m|`.
    frequencies
        How many `f0`: all bins, or as many evenly over the band where there are more bins.
    """

    wraps: int = 2
    frequencies: int = 17

    def __post_init__(self) -> None:
        checks.count("wraps", self.wraps)
        checks.count("frequencies", self.frequencies)

    def turns(self, band: Band, centre_frequency: float) -> Real:
        """As `RareErrors.turns`."""
        bins = band.frequencies
        agreeing = bins if bins.size <= self.frequencies else np.linspace(bins[0], bins[-1], self.frequencies)
        once = 2 * np.pi / centre_frequency * (bins - agreeing[:, None])
        return np.concatenate([m * once for m in range(-self.wraps, self.wraps + 1) if m != 0])


@dataclass(frozen=True)
class SubBandErrors:
    """A phase difference between the outer sub-bands off by more than half a wrap of delay: split spectrum.

    With `T = pi (B - b) / fc`, the upper sub-band differs by `T + u` and the lower by `u - T`, `u` from -T to T (at
    its ends one sub-band is wrong alone, as with few looks), or both the other way; nothing in between differs.

    Parameters
    ----------
    sub_bandwidth
        `b` [Hz], at most `B / 2`; `B / 3` where None, as of the estimator.
    divisions
        How many `u`.
    """

    sub_bandwidth: float | None = None
    divisions: int = 9

    def __post_init__(self) -> None:
        if self.sub_bandwidth is not None:
            checks.positive("sub_bandwidth", self.sub_bandwidth, "Hz")
        checks.count("divisions", self.divisions)

    def turns(self, band: Band, centre_frequency: float) -> Real:
        """As `RareErrors.turns`; ValueError where the sub-bands overlap."""
        width = band.bandwidth / 3 if self.sub_bandwidth is None else self.sub_bandwidth
        checks.within("sub_bandwidth", width, 0.0, band.bandwidth / 2, "Hz")
        side = np.sign(band.frequencies) * (np.abs(band.frequencies) > band.bandwidth / 2 - width)
        most = np.pi * (band.bandwidth - width) / centre_frequency
        common = np.linspace(-most, most, self.divisions)[:, None]
        upward = side * most + np.abs(side) * common
        return np.concatenate([upward, -upward])


@dataclass(frozen=True)
class PhaseErrors:
    """An interferometric phase carried over the edge of the cycle by noise: interferogram.

    The noise has to turn the phase by `b = pi - 2 pi fc |delay|`, and to do so in all bins, whose phases the delay has
    spread: the rival differs by `-+2 (b -+ 2 pi f delay)`, upper signs for a positive delay. Where `b` is above a
    quarter of a turn, noise has to cancel the echo whatever the edge, and `b` is a quarter.

    Parameters
    ----------
    delay
        The true delay [s], the same in all rows, within half a wrap of zero.
    """

    delay: float

    def __post_init__(self) -> None:
        checks.finite("delay", self.delay, "s")

    def turns(self, band: Band, centre_frequency: float) -> Real:
        """As `RareErrors.turns`; ValueError for a delay beyond half a wrap."""
        half_wrap = 0.5 / centre_frequency
        delay = checks.within("delay", self.delay, -half_wrap, half_wrap, "s")
        to_edge = min(np.pi * (1 - abs(delay) / half_wrap), np.pi / 2)
        turn: Real = 2 * (2 * np.pi * delay * band.frequencies - np.copysign(to_edge, delay))
        return turn[None]
