"""How far every estimator is held to what it claims: the ranges of its input, and what counts as a wrong number.

An estimate marked valid is wrong where it is not what it claims to be. A single one can only be so by its form: a
number that is not finite, a probability outside 0 to 1, a spread that is not above 0. Of many on independent echoes
claims are counts: `wrap_error_probability` adds up to the wrong wraps to expect, and 95 % of the errors in the right
wrap lie within 1.96 `delay_std`. As a window does not know the coherence and delay of its scene, claims hold over
scenes of all of them; at any one, wraps may be wrong `SHORT` times as often as claimed, and spreads as many times as
large. More than that, at a chance of one in a million, is a wrong number marked valid. An estimate that says its wrap
is as likely wrong as right claims nothing of its spread.

The factor has two causes. At exactly half a wrap an interferogram crosses the edge in half of all trials. As its phase
errs by what misalignment leaves, all of it across the phase and not half, it claims `atan(1 / sqrt(2)) / pi` = .196 on
average, 2.55 times too little; over delays within half a wrap that is made up for elsewhere. And noise outside the
band, such as the tails between samples of a single spike, moves group delays `sqrt(3) fs / B` times as far as noise
within it: 2.31 times at `fs = 4/3 B`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from estimators.estimate import DelayEstimate
from estimators.posterior import NORMAL_95

SNR = (-60.0, 120.0)
"""[dB]; and coherences of exactly 0 and 1."""

RELATIVE_BANDWIDTH = (1e-3, 1.9)

AMPLITUDE = (1e-150, 1e150)
"""Of series in double precision."""

SINGLE_AMPLITUDE = (1e-30, 1e30)
"""Of series in single precision."""

GRAZING_ANGLE = (0.01, 90.0)
"""[degrees]"""

SHORT = 2.6
"""How many times wraps may be wrong as often, and spreads as large, as claimed."""

OUTSIDE = 2 * float(stats.norm.sf(NORMAL_95 / SHORT))
"""Share of errors outside an interval that is so much too short."""

CHANCE = 1e-6

SHARES = ("coherence", "debiased_coherence", "wrap_error_probability", "quality")


@dataclass(frozen=True)
class Tally:
    """What valid estimates on independent echoes claimed, and what was found.

    Attributes
    ----------
    valid
        Number of valid estimates.
    broken
        Those of a form that cannot be.
    wrong, claimed
        Wrong wraps, found and claimed.
    sure, outside
        Those in the right wrap that claim to be, and errors of these outside their 95 % interval.
    worst
        Largest error in the right wrap [wraps]; NaN where there is none.
    """

    valid: int
    broken: int
    wrong: int
    claimed: float
    sure: int
    outside: int
    worst: float

    @property
    def holds(self) -> bool:
        """Whether nothing was wrong and marked valid."""
        if self.broken:
            return False
        wraps = stats.poisson.sf(self.wrong - 1, SHORT * self.claimed)
        spread = stats.binom.sf(self.outside - 1, self.sure, OUTSIDE)
        return bool(min(wraps, spread) >= CHANCE)


def broken(estimate: DelayEstimate) -> NDArray[np.bool_]:
    """Where an estimate is valid and of a form that cannot be."""
    finite = np.isfinite(estimate.delay) & (np.abs(estimate.phase) <= np.pi) & np.isfinite(estimate.delay_std)
    shares = [(getattr(estimate, name) >= 0) & (getattr(estimate, name) <= 1) for name in SHARES]
    sound = finite & (estimate.delay_std > 0) & np.all(shares, axis=0)
    wrong: NDArray[np.bool_] = estimate.valid & ~sound
    return wrong


def tally(estimate: DelayEstimate, delay: ArrayLike, centre_frequency: float, column: int) -> Tally:
    """Claims of one estimate in each row, whose echoes are independent, against the delays that were simulated.

    Parameters
    ----------
    estimate
        Of a pair.
    delay
        Simulated delay of each row [s].
    centre_frequency
        `fc` [Hz].
    column
        Sample of each row.
    """
    at = estimate.valid[:, column]
    claim = estimate.wrap_error_probability[at, column]
    error = np.abs(estimate.delay[:, column] - np.broadcast_to(delay, at.shape))[at] * centre_frequency
    # A hair more, as half a wrap is right by either rounding.
    right = error <= 0.5 + 1e-9
    sure = right & (claim < 0.5)
    outside = sure & (error > NORMAL_95 * estimate.delay_std[at, column] * centre_frequency)
    return Tally(
        valid=int(at.sum()),
        broken=int(broken(estimate).sum()),
        wrong=int((~right).sum()),
        claimed=float(claim.sum()),
        sure=int(sure.sum()),
        outside=int(outside.sum()),
        worst=float(error[right].max()) if right.any() else np.nan,
    )
