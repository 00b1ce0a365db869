"""What every setting of every estimator costs and gains on the same echoes, and what those of the simulator do."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from estimators import Estimator, FixedWindow, bounds
from sim import EchoPair, Sonar, speckle_pair
from sim.band import Real
from studies.catalogue.simulator_settings import simulators
from studies.parallel import one_thread
from studies.pareto import beaten_by
from studies.settings import expected_wrap_rate, settings
from studies.speed_columns import costs, errors_of
from studies.timing import Case, peak_bytes, prices

COHERENCES = (0.9, 0.6)
LOOKS = (9, 33)

DELAY = 1.5
"""Largest true delay [wraps]: of three wraps the right one has to be found."""

SAMPLES = 256
"""Of a row, critically sampled."""

TIMED = 4
"""Of so many rows one is timed."""

REPEATS = 5


def measure(sonar: Sonar, rows: int, rng: np.random.Generator) -> pd.DataFrame:
    """A row for each coherence, window and setting, and for each setting of the simulator.

    Echoes are rows of homogeneous speckle, each of a delay even within `DELAY` wraps, over which the windows slide;
    errors are read of windows that do not overlap. All but times, memory and what is dominated follows from `rng`.

    Parameters
    ----------
    sonar
        Centre frequency and bandwidth; of the simulator, all of it.
    rows
        Rows of speckle, of `SAMPLES` each; a quarter of them is timed.
    rng
        The only source of chance.
    """
    found: list[pd.DataFrame] = []
    with one_thread():
        for coherence in COHERENCES:
            pair = _speckle(sonar, rows, coherence, rng)
            for looks in LOOKS:
                found.append(_marked(pd.DataFrame(_compared(sonar, pair, coherence, looks)), "rmse"))
        found.append(_marked(pd.DataFrame(simulators(sonar, max(rows // 8, 2), rng)), "series_error"))
    return pd.concat(found, ignore_index=True)


def _speckle(sonar: Sonar, rows: int, coherence: float, rng: np.random.Generator) -> EchoPair:
    # One delay in each of as many equal parts of the range, so that few rows hold it as evenly as many.
    even = (rng.permutation(rows) + rng.random(rows)) / rows
    return speckle_pair(
        (rows, SAMPLES),
        coherence=coherence,
        delay=DELAY * (2 * even - 1) * sonar.wrap,
        centre_frequency=sonar.centre_frequency,
        bandwidth=sonar.bandwidth,
        sample_rate=sonar.bandwidth,
        rng=rng,
    )


def _compared(sonar: Sonar, pair: EchoPair, coherence: float, looks: int) -> Iterator[dict[str, Any]]:
    """All settings with a window of so many samples, each of which is a look."""
    chosen = settings(sonar, looks, DELAY)
    window = FixedWindow(1, looks)
    built = {one.name: one.build(window, FixedWindow(1, one.wide * looks)) for one in chosen}
    few = pair.rows(slice(0, max(pair.shape[0] // TIMED, 1)))
    echoes = {one.name: _single(few) if one.single else few for one in chosen}
    cases: dict[str, Case] = {name: _case(built[name], echoes[name]) for name in built}
    spent = prices(cases, few.primary.size, REPEATS)
    ziv_zakai = bounds.ziv_zakai_delay_std(
        looks, coherence, sonar.centre_frequency, sonar.bandwidth, 2 * DELAY * sonar.wrap
    )
    for one in chosen:
        estimator, name = built[one.name], one.name
        errors = _errors(estimator, _single(pair) if one.single else pair, looks)
        yield {
            "of": "estimator",
            "estimator": one.estimator,
            "setting": one.setting,
            "looks": float(looks),
            "coherence": coherence,
            "relative_bandwidth": sonar.relative_bandwidth,
            **costs(spent[name]),
            "peak_bytes_per_pixel": peak_bytes(cases[name]) / few.primary.size,
            **errors_of(errors, sonar, looks, coherence),
            "predicted_wrap_rate": expected_wrap_rate(estimator, one.wide * looks, coherence, sonar, DELAY),
            "ziv_zakai": float(ziv_zakai),
        }


def _case(estimator: Estimator, pair: EchoPair) -> Case:
    return lambda: estimator.estimate(pair)


def _single(pair: EchoPair) -> EchoPair:
    return replace(pair, primary=pair.primary.astype(np.complex64), secondary=pair.secondary.astype(np.complex64))


def _errors(estimator: Estimator, pair: EchoPair, looks: int) -> Real:
    """Of windows that do not overlap [s], shape (row, window)."""
    assert pair.truth is not None
    whole = pair.shape[1] // looks * looks
    errors: Real = estimator.estimate(pair).delay[:, looks // 2 : whole : looks] - pair.truth.delay
    return errors


def _marked(table: pd.DataFrame, error: str) -> pd.DataFrame:
    """With `dominated`, whether another setting beats one in cost and error, and which: the cheapest that does."""
    best = beaten_by(table.seconds_per_pixel.to_numpy(), table[error].to_numpy())
    names = (table.estimator + ", " + table.setting).to_numpy()
    return table.assign(dominated=best >= 0, beaten_by=np.where(best >= 0, names[best], ""))


def answer(table: pd.DataFrame) -> str:
    """For each window and coherence the cheapest setting that comes within a tenth of the least RMSE, and its price."""
    found = table[table.of == "estimator"]
    said = []
    for (coherence, looks), rows in found.groupby(["coherence", "looks"], sort=False):
        enough = rows[rows.rmse <= 1.1 * rows.rmse.min()]
        best = enough.loc[enough.seconds_per_pixel.idxmin()]
        said.append(
            f"{best.estimator} ({best.setting}) at {looks:.0f} looks and a coherence of {coherence:g}, "
            f"{best.seconds_per_pixel * 1e9:.0f} ns a pixel or {best.copies:.0f} copies, for an RMSE of "
            f"{best.rmse_over_crlb:.2f} bounds and {_rate(best)}"
        )
    dominated = int(found.dominated.sum())
    return (
        f"Cheapest within a tenth of the least RMSE are {'; '.join(said)}; {dominated} of {len(found)} settings are "
        f"beaten by another in cost and RMSE."
    )


def _rate(row: Mapping[str, Any]) -> str:
    return f"a wrap-error rate of {row['wrap_rate']:.2g} ({row['wrap_rate_low']:.2g} to {row['wrap_rate_high']:.2g})"
