"""What settings of the simulator cost, and by how much they change its echoes and what is estimated of them."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from estimators import CrossCorrelation, FixedWindow
from sim import EchoPair, Scene, Sonar, plan, simulate
from sim.band import Real
from studies.speed_columns import costs, errors_of
from studies.timing import peak_bytes, prices

SNR, RANGES = 15.0, (60.0, 90.0)
"""Of the flat floor in either receiver [dB], and its ends [m]."""

WINDOW = FixedWindow(1, 45)
"""Of the cross-correlation whose delays are held against the truth."""

REPEATS = 5

PLAIN: Mapping[str, Any] = {"delays": "scatterers", "scatterers_per_resolution": 8.0, "accuracy": 2e-7}

SETTINGS: Mapping[str, Mapping[str, Any]] = {
    "default": {},
    **{f"{n} scatterers in 1/B": {"scatterers_per_resolution": float(n)} for n in (1, 2, 4, 16)},
    **{f"accuracy {accuracy:g}": {"accuracy": accuracy} for accuracy in (1e-12, 1e-4, 1e-2)},
    "complex64": {"single": True},
    "warp": {"delays": "warp"},
}
"""One knob turned at a time, from 8 scatterers in a resolution cell and transforms of 2e-7."""


def simulators(sonar: Sonar, rows: int, rng: np.random.Generator) -> Iterator[dict[str, Any]]:
    """A row for each setting of the simulator, with the same random numbers: a flat floor at `SNR`.

    `series_error` is the root mean square difference of the primary from that of an accuracy of 1e-14 in double
    precision, over its own; only where the scatterers are the same. Errors are those of a cross-correlation, and its
    bound that of noise alone: the two angles of view decorrelate the echoes besides.
    """
    scene, seed = Scene(RANGES), int(rng.integers(2**63))

    def made(chosen: Mapping[str, Any]) -> EchoPair:
        required = plan(scene, sonar, snr=SNR, rows=rows, **{**PLAIN, **chosen})
        return simulate(scene, sonar, rng=np.random.default_rng(seed), snr=SNR, rows=rows, required=required)

    finest = made({"accuracy": 1e-14})
    cases = {name: partial(made, chosen) for name, chosen in SETTINGS.items()}
    spent = prices(cases, finest.primary.size, REPEATS)
    for name, case in cases.items():
        pair = case()
        looks = WINDOW.looks(pair)
        coherence = 1 / (1 + 10 ** (-SNR / 10))
        same = {"scatterers_per_resolution", "delays"}.isdisjoint(SETTINGS[name])
        yield {
            "of": "simulator",
            "estimator": "simulator",
            "setting": name,
            "looks": looks,
            "coherence": coherence,
            "relative_bandwidth": sonar.relative_bandwidth,
            **costs(spent[name]),
            "peak_bytes_per_pixel": peak_bytes(case) / pair.primary.size,
            **errors_of(_errors(pair), sonar, looks, coherence),
            "series_error": _relative(pair.primary, finest.primary) if same else np.nan,
        }


def _relative(series: Any, exact: Any) -> float:
    return float(np.sqrt(np.mean(np.abs(series - exact) ** 2) / np.mean(np.abs(exact) ** 2)))


def _errors(pair: EchoPair) -> Real:
    """Of windows that do not overlap and lie on the floor [s], shape (row, window)."""
    assert pair.truth is not None
    floor = np.flatnonzero(np.isfinite(pair.truth.delay))
    apart = floor[WINDOW.samples : -WINDOW.samples : WINDOW.samples]
    errors: Real = CrossCorrelation(WINDOW).estimate(pair).delay[:, apart] - pair.truth.delay[apart]
    return errors
