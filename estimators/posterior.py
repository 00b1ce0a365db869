"""How widely a delay may lie about its peak within the wrap, given the sample coherence there.

Over N looks of circular Gaussian series the secondary is the primary times a complex number, and noise. With the scale
of the noise and the number's magnitude integrated out, the likelihood of a delay is `(1 - c(tau)^2)^-(N - 1/2)` where
the normalised passband correlation `c(tau) = Re{exp(2 pi i fc tau) C(tau)} / E` is positive, and 1 where it is not:
about a peak of height g Student's t of 2N - 2 degrees of freedom, which the phase error follows exactly whatever the
true coherence, as `sin(phi) g sqrt(2N - 2) / sqrt(1 - g^2)` does. The bound at the debiased coherence instead covers
less than it says at few looks: 87 to 92 % of errors for 5 to 15 looks.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.special import stdtr

from estimators.even_table import read_even
from sim.band import Real

Looks = float | Real
"""Independent looks of a window: a number, or one for each time."""

Table = tuple[Real, Real]
"""Places, and the values there."""

NODES = 129
"""Coherences at which intervals are tabulated: even steps in the angle whose sine they are, with which intervals near
full coherence go to zero on a straight line: from where they no longer fill the wrap, late in a narrow band."""

LAST_NODES = 41
"""More, at even ratios of the angle's distance from the quarter turn, in the last step."""

ROUNDING = 3e-7
"""Least such distance, and root of `1 - g^2`, that rounding leaves to be told; nearer to 1 nothing more is claimed."""

GUESS = 0.475
"""Half-width of the 95 % interval of a guess within a wrap [wraps]."""

NORMAL_95 = 1.959963984540054
"""Half the width of a 95 % interval of a normal distribution, in standard deviations."""


def delay_std(coherence: Real, looks: Looks, relative_bandwidth: float, *, refine: bool) -> Real:
    """Half of the 95 % interval of a delay within its wrap, over 1.96 [wraps].

    The interval holds 95 % of the likelihood `(1 - g^2 s(tau)^2)^-n` within half a wrap, where `s` is positive, and of
    1 where it is not: `s = cos(2 pi fc tau)` and `n = N - 1/2` where the phase refines the delay, `s = sinc(W B tau)`
    and `n = N - 1` where it does not, with the share W of the band that N looks of speckle fill. For many looks that is
    1.96 times the Cramér-Rao bound; a guess within a wrap has 0.24. It is never 0: rounding leaves something.

    Parameters
    ----------
    coherence
        Sample coherence `g` at the delay, shape (..., time).
    looks
        Equivalent independent looks; of a single one nothing is known.
    relative_bandwidth
        `B / fc`.
    refine
        Whether the phase refines the delay.
    """
    bandwidth = 0.0 if refine else relative_bandwidth
    return read_by_looks(coherence, looks, lambda n: _widths(n, bandwidth)) / NORMAL_95


def phase_std(concentration: Real) -> Real:
    """Half of the 95 % interval of a phase of von Mises' density `exp(k cos(phi))`, over 1.96 [rad]."""
    log_k, widths = _von_mises_widths()
    width: Real = np.exp(np.interp(np.log(np.maximum(concentration, 1e-30)), log_k, widths))
    return width / NORMAL_95


@lru_cache(maxsize=1)
def _von_mises_widths() -> tuple[Real, Real]:
    """Log of the half-width of 95 % [rad] over that of the concentration."""
    log_k = np.linspace(np.log(1e-2), np.log(1e12), 257)
    phase = np.concatenate([[0.0], np.geomspace(1e-8, np.pi, 2000)])
    density = np.exp(-2 * np.exp(log_k)[:, None] * np.sin(phase / 2) ** 2)
    return log_k, np.log([np.interp(0.95 * line[-1], line, phase) for line in _cumulated(density, phase)])


def _cumulated(density: Real, at: Real) -> Real:
    steps = np.diff(at) * (density[:, 1:] + density[:, :-1]) / 2
    return np.pad(np.cumsum(steps, axis=1), ((0, 0), (1, 0)))


def read_by_looks(coherence: Real, looks: Looks, tables: Callable[[float], tuple[Table, Table]]) -> Real:
    """Tables over the angle whose sine is the coherence, for one number of looks or each distinct one at its times.

    The first has even steps, the second is finer in the last of these.
    """
    angle = np.arcsin(coherence)
    distinct, which = np.unique(looks, return_inverse=True)
    if len(distinct) == 1:
        return _read(angle, *tables(float(distinct[0])))
    read = np.empty(coherence.shape)
    for number, n in enumerate(distinct):
        at = which == number
        read[..., at] = _read(angle[..., at], *tables(float(n)))
    return read


def _read(angle: Real, even: Table, last: Table) -> Real:
    read = read_even(angle, *even)
    near = angle > last[0][0]
    if near.any():
        read[near] = np.interp(angle[near], *last)
    return read


@lru_cache(maxsize=256)
def _widths(looks: float, relative_bandwidth: float) -> tuple[Table, Table]:
    """Half-widths of 95 % [wraps] over the angle; at a bandwidth of zero those of the carrier."""
    even = np.linspace(0, np.pi / 2, NODES)
    last = np.pi / 2 - np.geomspace(even[1], ROUNDING, LAST_NODES)
    if looks <= 1:
        return (even, np.full(NODES, GUESS)), (last, np.full(LAST_NODES, GUESS))
    angles = np.concatenate([even[:-1], last])
    delay = np.concatenate([[0.0], np.geomspace(1e-11, 0.5, 1100)])
    refined = relative_bandwidth == 0
    # The power of N looks of speckle spreads over less than the band: the mean of 1 / W^2 of the share W of its rms
    # width, which is N / (N + 1) in the mean of W^2 with the variance 0.8 / (N + 1), to second order.
    narrowing = np.sqrt((1 + 1 / looks) * (1 + 0.8 / (looks + 1)))
    # 1 - s^2, without the difference where s is near 1.
    if refined:
        short = np.where(delay < 0.25, np.sin(2 * np.pi * delay), 1.0) ** 2
    else:
        turn = np.pi * relative_bandwidth * delay / narrowing
        sinc = np.maximum(np.sinc(turn / np.pi), 0.0)
        short = np.where(turn < 1e-2, turn**2 / 3 * (1 - 2 * turn**2 / 15), (1 - sinc) * (1 + sinc))
    power = looks - (0.5 if refined else 1.0)
    likelihood = np.exp(-power * np.log1p(np.tan(angles[:, None]) ** 2 * short))
    held = _cumulated(likelihood, delay)
    widths = np.array([np.interp(0.95 * line[-1], line, delay) for line in held])
    return (even, np.append(widths[: NODES - 1], widths[-1])), (last, widths[NODES - 1 :])


def beyond_edge(coherence: Real, phase: Real, looks: Looks) -> Real:
    """Probability that noise carried a phase over the edge of the wrap, `pi - |phase|` away.

    Of Student's t with `f = 2N - 2` degrees of freedom, that `g sin(d) sqrt(f / (1 - g^2))` is exceeded for the
    distance `d` to the edge, a quarter turn at the most. Its logarithm is read from a table over the root of
    `u = log(1 + g^2 sin(d)^2 / (1 - g^2))`, in which it is nearly straight; within 2e-4 of itself, and 0 below 1e-30.

    Parameters
    ----------
    coherence, phase
        Sample coherence `g` and phase [rad], shape (..., time).
    looks
        Equivalent independent looks `N`; of a single one nothing is known, 1/2.
    """
    sine = np.sin(np.minimum(np.pi - np.abs(phase), np.pi / 2))
    place = np.sqrt(np.log1p((coherence * sine) ** 2 / np.maximum((1 - coherence) * (1 + coherence), 1e-300)))
    distinct, which = np.unique(looks, return_inverse=True)
    beyond = np.empty(np.shape(coherence))
    for number, one in enumerate(distinct):
        at = slice(None) if len(distinct) == 1 else which == number
        table = _log_beyond(float(one)) if one > 1 else None
        beyond[..., at] = 0.5 if table is None else np.exp(read_even(place[..., at], *table, beyond=-np.inf))
    return beyond


@lru_cache(maxsize=256)
def _log_beyond(looks: float) -> tuple[Real, Real]:
    """Root of `u`, and the log of Student's tail at `t = sqrt(f (e^u - 1))`, down to 1e-30."""
    freedom = 2 * (looks - 1)
    # No further than `e^u` is a number.
    place = np.linspace(0.0, np.sqrt(min(2 * 69.0 / freedom, 700.0)), 1025)
    tail = stdtr(freedom, -np.sqrt(freedom * np.expm1(place**2)))
    return place, np.log(np.maximum(tail, 1e-300))
