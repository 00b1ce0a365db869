"""The settings of the estimators whose speed is weighed against their accuracy."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from estimators import (
    CrossCorrelation,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
    bounds,
)
from sim import Sonar
from studies.measure import predicted_delay_std, predicted_wrap_rate

DEFAULT = "default"

WIDE = 3
"""How many times as long as the window is that from which two windows take the wrap."""

WIDTHS = (2, 4, 6)
"""Parts of the band that the sub-bands of a split spectrum are, besides the third by default."""

Kind = Callable[..., Estimator]
Options = Mapping[str, Any]


@dataclass(frozen=True)
class Setting:
    """An estimator with one choice of its knobs.

    Attributes
    ----------
    estimator, setting
        Names of the method and of what differs from its defaults.
    build
        Makes it, from the window whose resolution it has and a longer one.
    wide
        How many times as long as the window the echoes are that it takes the wrap from.
    single
        Whether it is given series of single precision.
    """

    estimator: str
    setting: str
    build: Callable[[FixedWindow, FixedWindow], Estimator]
    wide: int = 1
    single: bool = False

    @property
    def name(self) -> str:
        """Both names."""
        return f"{self.estimator}, {self.setting}"


def settings(sonar: Sonar, looks: int, delay: float) -> list[Setting]:
    """Every estimator with its knobs, one turned at a time, and its defaults in single precision.

    Lags are those in `1 / B`, sub-bands shares of the band. Left out is what a window cannot hold: sub-bands without a
    Fourier bin and searches beyond half of it.

    Parameters
    ----------
    sonar
        Its band decides searches and sub-bands.
    looks
        Independent looks in the window.
    delay
        Largest true delay [wraps]; the narrow search reaches one wrap further, the wide one to `2 / B`.
    """
    narrow, band = (delay + 1) * sonar.wrap, sonar.bandwidth
    # A record of an even number of looks lasts not quite as many `1 / B` (studies.patch).
    held = looks if looks % 2 else looks - 1
    searches: dict[str, Options] = {}
    if narrow * band < 1 and 2 * narrow * band <= held:
        searches[f"search {delay + 1:g} wraps"] = {"search": narrow}
    if held >= 4:
        searches["search 2/B"] = {"search": 2 / band}
    lags: dict[str, Options] = {f"{n} lags": {"lags_per_resolution": n} for n in (8, 16)}
    group: dict[str, Options] = {"no refinement": {"refine": False}}
    widths: dict[str, Options] = {f"b = B/{n}": {"sub_bandwidth": band / n} for n in WIDTHS if n <= held}
    bands: dict[str, Options] = {f"{n} bands": {"bands": n} for n in (2, 3, 9) if n <= held}
    coarse: dict[str, Options] = {f"{n} lags": {"lags_per_resolution": n} for n in (4, 8)}
    strongest: Options = {"peak": "strongest", "lags_per_resolution": 8}
    default: dict[str, Options] = {DEFAULT: {}}
    found = [
        *_family("interferogram", Interferogram, default),
        *_family("cross-correlation", CrossCorrelation, default | lags | searches | group),
        *_family("split-spectrum", SplitSpectrum, default | widths | group),
        *_family("multi-chromatic", MultiChromatic, (default | bands | group) if held >= 5 else bands),
        *_family(
            "phase-slope", FullBandPhaseSlope, default | coarse | searches | {"strongest, 8 lags": strongest} | group
        ),
        *_family("maximum-likelihood", MaximumLikelihood, default | lags | searches),
        *_two_windows(),
    ]
    return [*found, *(replace(one, setting="complex64", single=True) for one in found if one.setting == DEFAULT)]


def _family(name: str, kind: Kind, choices: Mapping[str, Options]) -> Iterator[Setting]:
    for setting, options in choices.items():
        yield Setting(name, setting, partial(_one_window, kind, options))


def _two_windows() -> Iterator[Setting]:
    for setting, kind, options in (
        (DEFAULT, CrossCorrelation, {}),
        ("4 lags", CrossCorrelation, {"lags_per_resolution": 4}),
        ("wrap by likelihood", MaximumLikelihood, {}),
        ("wrap by split spectrum", SplitSpectrum, {}),
    ):
        yield Setting("two-window", setting, partial(_wrap_and_phase, kind, options), WIDE)


def _one_window(kind: Kind, options: Options, window: FixedWindow, wide: FixedWindow) -> Estimator:
    return kind(window, **options)


def _wrap_and_phase(kind: Kind, options: Options, window: FixedWindow, wide: FixedWindow) -> Estimator:
    return TwoWindow(kind(wide), window, **options)


def expected_wrap_rate(estimator: Estimator, looks: float, coherence: float, sonar: Sonar, delay: float) -> float:
    """Wrap-error rate to expect of an estimator whose wrap has so many looks, for delays even within `delay` wraps.

    As `measure.predicted_wrap_rate`, but for an interferogram: it is right where the true delay and the error of its
    phase add up to less than half a wrap, for which the distribution of the phase is exact.
    """
    if isinstance(estimator, Interferogram):
        if delay == 0:
            return 0.0
        phase = (np.arange(4096) + 0.5) / 4096 * np.pi
        error = phase / (2 * np.pi)
        overlap = np.maximum(np.minimum(delay, 0.5 - error) + np.minimum(delay, 0.5 + error), 0.0)
        density = bounds.multilook_phase_pdf(phase, looks, coherence)
        return float(np.average(1 - overlap / (2 * delay), weights=density))
    resolves = estimator.wrap if isinstance(estimator, TwoWindow) else estimator
    return float(predicted_wrap_rate(resolves, looks, coherence, sonar))


def expected_std(estimator: Estimator, looks: float, coherence: float, sonar: Sonar) -> float:
    """Spread to expect in the right wrap of an estimator whose phase has so many looks [s]."""
    reads = Interferogram(estimator.phase) if isinstance(estimator, TwoWindow) else estimator
    return float(predicted_delay_std(reads, looks, coherence, sonar))
