"""Where an estimator is to work, and what is asked of it."""

from dataclasses import dataclass

import numpy as np

from estimators import CrossCorrelation, FixedWindow, bounds
from sim import Sonar, checks
from studies.patch import Patch
from studies.settings import Setting, expected_std, expected_wrap_rate

MOST_LOOKS = 5_000


@dataclass(frozen=True)
class Tolerance:
    """What is asked for.

    Attributes
    ----------
    over_bound
        The spread in the right wrap is at most `1 + over_bound` times the coherent Cramér-Rao bound; .001 to 100.
    wrap_rate
        Largest wrap-error rate; 1e-8 to 1.
    """

    over_bound: float
    wrap_rate: float

    def __post_init__(self) -> None:
        checks.within("over_bound", self.over_bound, 1e-3, 100.0)
        checks.within("wrap_rate", self.wrap_rate, 1e-8, 1.0)

    @property
    def std_over_crlb(self) -> float:
        """Largest ratio of the spread to the bound."""
        return 1 + self.over_bound

    def excess(self, std_over_crlb: float, wrap_rate: float) -> float:
        """How many times as large as allowed the worse of both is."""
        worse = np.maximum(std_over_crlb / self.std_over_crlb, wrap_rate / self.wrap_rate)
        # Of what gave no number nothing is near.
        return float(np.nan_to_num(worse, nan=np.inf, posinf=np.inf))


@dataclass(frozen=True)
class Condition:
    """Homogeneous speckle as a window sees it.

    Attributes
    ----------
    sonar
        Centre frequency and bandwidth.
    looks
        Independent looks in the window, 3 to 5,000.
    coherence
        Of the two series, .01 to .9999.
    delay
        True delays are even within so many wraps of zero.
    """

    sonar: Sonar
    looks: int
    coherence: float
    delay: float = 0.5

    def __post_init__(self) -> None:
        if checks.count("looks", self.looks, least=3) > MOST_LOOKS:
            raise ValueError(f"looks is {self.looks}; it must be at most {MOST_LOOKS}")
        checks.within("coherence", self.coherence, 0.01, 0.9999)
        # A search as far as 1 / B must hold it and its rivals.
        checks.within("delay", self.delay, 0.0, max(0.5, 1 / self.sonar.relative_bandwidth - 1), "wraps")

    @property
    def crlb(self) -> float:
        """Coherent Cramér-Rao bound of the delay [s]."""
        return self._crlb(self.looks)

    def _crlb(self, looks: int) -> float:
        fc, bandwidth = self.sonar.centre_frequency, self.sonar.bandwidth
        return float(bounds.coherent_delay_crlb(looks, self.coherence, fc, bandwidth))

    def looks_of(self, wide: int) -> int:
        """Looks of the echoes that a wrap is taken from; odd where the window is a part of them."""
        return self.looks if wide == 1 else wide * self.looks | 1

    def patch(self, wide: int) -> Patch:
        """Periodic records of so many looks."""
        return Patch(looks=self.looks_of(wide), coherence=self.coherence, delay=self.delay)

    def windows(self, wide: int) -> tuple[FixedWindow, FixedWindow]:
        """The window, and the record that holds it."""
        record = FixedWindow(*self.patch(wide).record())
        return (record if wide == 1 else FixedWindow(1, self.looks)), record

    def predicted(self, setting: Setting) -> tuple[float, float]:
        """Spread over the bound and wrap-error rate to expect of a setting."""
        estimator = setting.build(*self.windows(setting.wide))
        std = expected_std(estimator, self.looks, self.coherence, self.sonar)
        resolving = self.looks_of(setting.wide)
        return std / self.crlb, expected_wrap_rate(estimator, resolving, self.coherence, self.sonar, self.delay)

    def looks_needed(self, tolerance: Tolerance) -> int | None:
        """Least looks with which a cross-correlation is predicted to meet a tolerance; None beyond `MOST_LOOKS`."""
        estimator = CrossCorrelation(FixedWindow(1, self.looks))

        def enough(looks: int) -> bool:
            std = expected_std(estimator, looks, self.coherence, self.sonar) / self._crlb(looks)
            rate = expected_wrap_rate(estimator, looks, self.coherence, self.sonar, self.delay)
            return tolerance.excess(std, rate) <= 1

        if not enough(MOST_LOOKS):
            return None
        low, high = 2, 4
        while not enough(high):
            low, high = high, min(2 * high, MOST_LOOKS)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if enough(middle) else (middle, high)
        return high
