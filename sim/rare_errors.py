"""Kinds of rare error: by how much an estimator prefers the truth to what it may take for it, its rivals.

With the cross spectrum `X_k = P_k* S_k exp(2 pi i (fc + f_k) tau)`, of which the coherence is the mean, an error comes
near where `T = sum_k Re{v_k X_k}` is negative for some rival. For one that differs from the truth by the phase
`phi_k` in Fourier bin k, T is the difference of their log-likelihoods up to a factor, and `v_k = 1 - exp(-i phi_k)`.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import minimize_scalar

from sim import checks
from sim.band import Band, Complex, Real


class RareErrors(Protocol):
    """A kind of error."""

    def preferences(self, band: Band, centre_frequency: float, coherence: float) -> Complex:
        """`v` of each rival in each Fourier bin, shape (rival, bin), with `sum_k Re{v_k} >= 0`.

        The band has a centre frequency [Hz], and the two series a coherence magnitude, 0 to 1.
        """


def preference(turns: Real) -> Complex:
    """`1 - exp(-i phi)` without cancellation."""
    over: Complex = 2 * np.sin(turns / 2) * np.exp(0.5j * (np.pi - turns))
    return over


@dataclass(frozen=True)
class DelayErrors:
    """A delay off by a wrap or more, as of a search over delay: cross-correlation, phase slope, maximum likelihood.

    A rival `m` wraps off differs by `2 pi m (f - f0) / fc`: the envelope does not see its phase, so that the frequency
    `f0` where it agrees with the truth is anywhere in the band. (Few looks of high coherence err where a single bin
    outshines all others: then it is that bin's.)

    Parameters
    ----------
    wraps
        The `m`, to either side; not whole ones alone, as peaks of the envelope can be anywhere. Errors begin with the
        delay half-way. For `B / fc` from .9 on, where the envelope is as narrow as a wrap, (.8, 1, 1.2, ..., 2) is
        better by up to three times in standard error.
    frequencies
        How many `f0`: all bins, or as many evenly over the band where there are more bins.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    wraps: tuple[float, ...] = (1.0, 1.25, 1.5, 1.75, 2.0)
    frequencies: int = 17

    def __post_init__(self) -> None:
        if not self.wraps:
            raise ValueError("wraps is empty; it must name at least one")
        for size in self.wraps:
            checks.positive("wraps", size)
        checks.count("frequencies", self.frequencies)

    def preferences(self, band: Band, centre_frequency: float, coherence: float) -> Complex:
        """As `RareErrors.preferences`: for a centre frequency [Hz] and a coherence, shape (rival, bin)."""
        bins = band.frequencies
        agreeing = bins if bins.size <= self.frequencies else np.linspace(bins[0], bins[-1], self.frequencies)
        once = 2 * np.pi / centre_frequency * (bins - agreeing[:, None])
        return preference(np.concatenate([m * once for size in self.wraps for m in (-size, size)]))


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

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    sub_bandwidth: float | None = None
    divisions: int = 9

    def __post_init__(self) -> None:
        if self.sub_bandwidth is not None:
            checks.positive("sub_bandwidth", self.sub_bandwidth, "Hz")
        checks.count("divisions", self.divisions)

    def preferences(self, band: Band, centre_frequency: float, coherence: float) -> Complex:
        """For a centre frequency [Hz] and a coherence, shape (rival, bin); ValueError where the sub-bands overlap."""
        width = band.bandwidth / 3 if self.sub_bandwidth is None else self.sub_bandwidth
        checks.within("sub_bandwidth", width, 0.0, band.bandwidth / 2, "Hz")
        side = np.sign(band.frequencies) * (np.abs(band.frequencies) > band.bandwidth / 2 - width)
        most = np.pi * (band.bandwidth - width) / centre_frequency
        common = np.linspace(-most, most, self.divisions)[:, None]
        upward = side * most + np.abs(side) * common
        return preference(np.concatenate([upward, -upward]))


@dataclass(frozen=True)
class PhaseErrors:
    """An interferometric phase carried over the edge of the cycle: interferogram.

    The sum of the cross spectrum errs on the far side of a line through zero, whose normal points
    `beta_k = b + 2 pi f_k |delay|` from the truth in bin k, `b = 2 pi fc |delay| - pi / 2`; up to a quarter of a wrap
    noise has to cancel the echo wherever the edge is, and b is zero. So `v_k = 2 x exp(-i beta_k)`, with the x that
    makes the probability bound `M` of `rare_speckle_pair` least: the saddle point. Bins whose own phase lies over
    the edge brighten, as then speckle errs without noise.

    Parameters
    ----------
    delay
        The true delay [s], the same in all rows, within half a wrap of zero.

    Raises
    ------
    ValueError
        For a value outside these limits, or not finite.
    """

    delay: float

    def __post_init__(self) -> None:
        checks.finite("delay", self.delay, "s")

    def preferences(self, band: Band, centre_frequency: float, coherence: float) -> Complex:
        """For a centre frequency [Hz] and a coherence, shape (1, bin); ValueError for a delay beyond half a wrap."""
        half_wrap = 0.5 / centre_frequency
        delay = abs(checks.within("delay", self.delay, -half_wrap, half_wrap, "s"))
        beta = max(2 * np.pi * centre_frequency * delay - np.pi / 2, 0.0) + 2 * np.pi * band.frequencies * delay
        strength = coherence**2 / ((1 - coherence) * (1 + coherence))
        # Beyond, nothing is left of a bin; the saddle point is a mean of the cosines.
        most = min(1.0, float(np.min(np.cos(beta) + np.sqrt(np.cos(beta) ** 2 + 1 / max(strength, 1e-300)))))
        best = minimize_scalar(
            lambda x: -np.log1p(strength * x * (2 * np.cos(beta) - x)).sum(), bounds=(0.0, most), method="bounded"
        )
        preferences: Complex = 2 * float(best.x) * np.exp(-1j * np.copysign(1.0, self.delay) * beta)[None]
        return preferences
