"""A setting with what it costs and gives, and whether that is enough."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sim import DelayErrors, EchoPair, Sonar, SubBandErrors, rare_speckle_pair, speckle_pair
from studies import statistics
from studies.moments import Moments, of_errors
from studies.patch import Draw
from studies.settings import WIDE, WIDTHS, Setting
from studies.statistics import Interval
from studies.timing import Quartiles
from studies.tuning.condition import Condition, Tolerance

CONFIDENCE = 0.99
"""Of all intervals."""

HALF_WIDTH = 2.5758293035489004
"""Half the width of such an interval of a normal distribution, in standard deviations."""

FEW_ERRORS = 20
"""Wrong wraps to expect at the tolerance, below which rare ones are made frequent."""

MOST_TRIALS, MOST_RARE, FEWEST_TRIALS = 60_000, 30_000, 500


@dataclass(frozen=True)
class Judged:
    """A setting, what it costs, what it gives, and whether it meets the tolerance.

    Attributes
    ----------
    setting
        The setting.
    seconds_per_pixel, copies
        Processor time a pixel [s], and in copies of both series: medians with quartiles.
    std_over_crlb, wrap_rate
        With their 99 % intervals, of the last simulation of it; predicted, with no width, where there was none.
    trials
        Of that simulation, which gave the spread; 0 where there was none. Rates that these are too few for come from
        others, in which rare errors are frequent; a rate that is 0 by theory, and was, has no width.
    rmse_over_crlb
        Of the simulation in which all settings see the same echoes, wraps included; NaN where it was left out.
    fails
        Why it does not meet the tolerance; empty where that was not found.
    confirmed
        Whether fresh echoes show that it does.
    """

    setting: Setting
    seconds_per_pixel: Quartiles
    copies: Quartiles
    std_over_crlb: Interval
    wrap_rate: Interval
    trials: int = 0
    rmse_over_crlb: float = np.nan
    fails: str = ""
    confirmed: bool = False

    def excess(self, tolerance: Tolerance) -> float:
        """How many times as large as allowed the worse of spread and wrap-error rate is."""
        return tolerance.excess(self.std_over_crlb.value, self.wrap_rate.value)

    def beyond(self, tolerance: Tolerance) -> str:
        """Which of the intervals lies beyond the tolerance as a whole; empty where neither does."""
        return self._which(tolerance, "low", "{name} {value} is above {allowed:g}")

    def not_within(self, tolerance: Tolerance) -> str:
        """Which of the intervals does not lie within the tolerance as a whole; empty where both do."""
        return self.beyond(tolerance) or self._which(
            tolerance, "high", "{name} {value} may be {high}, above {allowed:g}"
        )

    def _which(self, tolerance: Tolerance, end: str, words: str) -> str:
        for name, allowed, interval, digits in (
            ("STD/CRLB", tolerance.std_over_crlb, self.std_over_crlb, ".4g"),
            ("wrap rate", tolerance.wrap_rate, self.wrap_rate, ".2g"),
        ):
            if not getattr(interval, end) <= allowed:
                value, high = format(interval.value, digits), format(interval.high, digits)
                return words.format(name=name, value=value, high=high, allowed=allowed)
        return ""


class Records:
    """Echoes to judge settings by, drawn once and the same for all that need as many looks.

    Parameters
    ----------
    condition, tolerance
        What they are, and how rare the errors are that count.
    samples
        About as many, in at most `MOST_TRIALS` records.
    rng
        The only source of chance. What is drawn does not depend on the order of asking.
    """

    def __init__(self, condition: Condition, tolerance: Tolerance, samples: int, rng: np.random.Generator) -> None:
        self.condition, self.tolerance, self.samples = condition, tolerance, samples
        self._streams = dict(zip(((1, False), (1, True), (WIDE, False), (WIDE, True)), rng.spawn(4), strict=True))
        self._drawn: dict[tuple[int, bool], EchoPair] = {}

    def measured(self, one: Judged, *, rare: bool = False) -> Judged:
        """A setting with statistics of its errors on these echoes; of rare wrong wraps, where asked for, on others."""
        wide, crlb = one.setting.wide, self.condition.crlb / self.condition.sonar.wrap
        moments = self._moments(one.setting, rare=False)
        std, rmse = statistics.std_in_wrap(moments), statistics.rmse(moments)
        half = HALF_WIDTH * std.error
        few = rare and self.tolerance.wrap_rate * self.trials(wide) < FEW_ERRORS
        # What cannot err, as a phase alone where there is no delay, has no rare errors to be drawn.
        never = self.condition.predicted(one.setting)[1] == 0 == moments.wrap_errors
        wraps = self._moments(one.setting, rare=True) if few and not never else moments
        rate = statistics.clopper_pearson(wraps, "wrong", confidence=CONFIDENCE)
        return replace(
            one,
            std_over_crlb=Interval(std.value / crlb, (std.value - half) / crlb, (std.value + half) / crlb),
            wrap_rate=Interval(0.0, 0.0, 0.0) if never else rate,
            rmse_over_crlb=rmse.value / crlb,
            trials=moments.trials,
        )

    def trials(self, wide: int) -> int:
        """Records of a width."""
        held = self.samples // self.condition.patch(wide).record()[1]
        return min(max(held, FEWEST_TRIALS), MOST_TRIALS)

    def _moments(self, setting: Setting, *, rare: bool) -> Moments:
        """Of the errors of one estimate a record, in wraps."""
        pair = self._pair(setting.wide, rare)
        assert pair.truth is not None
        estimate = setting.build(*self.condition.windows(setting.wide)).estimate(pair)
        errors = (estimate.delay[:, :1] - pair.truth.delay) / self.condition.sonar.wrap
        weights = 1.0 if pair.likelihood_ratio is None else pair.likelihood_ratio[:, None]
        outliers = np.abs(errors) > 0.5 / self.condition.sonar.relative_bandwidth
        return of_errors(errors, outliers, weights=weights)[0]

    def _pair(self, wide: int, rare: bool) -> EchoPair:
        key = wide, rare
        if key not in self._drawn:
            sonar, trials = self.condition.sonar, self.trials(wide)
            draw, trials = (_rare(sonar), min(trials, MOST_RARE)) if rare else (speckle_pair, trials)
            self._drawn[key] = self.condition.patch(wide).drawn(draw, sonar, trials, self._streams[key])
        return self._drawn[key]


def _rare(sonar: Sonar) -> Draw:
    """Draws records in which the rare errors of all settings are frequent."""
    widths = (None, *(sonar.bandwidth / n for n in WIDTHS))
    return partial(rare_speckle_pair, errors=(DelayErrors(), *(SubBandErrors(width) for width in widths)))
