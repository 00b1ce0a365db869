"""One long scene in blocks that go on, errors read metre by metre, and what is stored for its figures."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from estimators import AdaptiveWindow, CrossCorrelation, CrossCorrelationInPieces, FixedWindow, KnownCoherence
from sim import SONARS, Scene, SnrProfile, plan, simulate
from studies import catalogue, engine, report
from studies.catalogue.long_range import crossing
from studies.design import methods, points, task
from studies.measure import echoes
from studies.swath import Swath

STRIP = {
    "scene.ground_range": [100, 106],
    "scene.features": [{"kind": "trawl-mark", "ground_range": 103, "direction": 60}],
    "scene.overlap": 5,
    "trials.count": 24,
    "trials.block": 12,
}


@pytest.fixture(scope="module")
def strip():
    """Two blocks of twelve rows, six metres of range; no coarser than they come."""
    study = catalogue.study("long-range").model_copy(update={"figures": (), "answer": None})
    windows = [[5, 9], {"policy": "adaptive", "kappa": 2.0, "largest": 5}]
    chosen = [
        {"name": "phase", "method": "Interferogram", "windows": windows},
        {"name": "correlation", "method": "CrossCorrelationInPieces", "windows": [[5, 9]], "blocks": 1},
    ]
    return study.with_values({**STRIP, "estimators": chosen})


@pytest.fixture(scope="module")
def run(strip, tmp_path_factory):
    folder = tmp_path_factory.mktemp("strip")
    engine.run(strip, engine.Run(jobs=1, backend="sequential"), folder)
    store = engine.store_of(strip, 2026, folder)
    return report.result(strip, store), store


def test_blocks_are_parts_of_one_scene_whatever_their_size(strip):
    other = strip.with_values({"trials.block": 8})
    for point, same in zip(points(strip), points(other), strict=True):
        first, second = (echoes(task(strip, point, block), 12, 1) for block in (0, 1))
        assert first.shape == second.shape == (22, first.shape[1])
        # The second block begins 12 rows on, so that 10 of them are those that the first overlaps.
        assert first.primary[12:].tobytes() == second.primary[:10].tobytes()
        smaller = echoes(task(other, same, 1), 8, 1)
        assert smaller.secondary.tobytes() == first.secondary[8:22][:18].tobytes() + second.secondary[10:14].tobytes()
        np.testing.assert_array_equal(first.truth.height[12:], second.truth.height[:10])


def test_every_error_is_read_in_its_own_metre_and_in_rows_of_its_block(strip):
    point = next(points(strip))
    pair = echoes(task(strip, point, 0), 12, 1)
    slant = pair.grid.times * 1480.0 / 2
    ground = np.sqrt(slant**2 - 42.0**2)
    for method in methods(strip, point)[:2]:
        window = method.window.on(pair)
        readings = point.world.read(pair, window, method.build(np.random.default_rng(0)).estimate(pair))
        assert [reading.facts["ground_range"] for reading in readings] == [100.5, 101.5, 102.5, 103.5, 104.5, 105.5]
        for reading in readings:
            middle = reading.facts["ground_range"]
            assert np.abs(ground[reading.samples] - middle).max() <= 0.5
            rows = np.arange(22)[reading.rows]
            most = np.broadcast_to(window.rows, ground.shape)[reading.samples].max()
            assert rows.min() - most // 2 >= 5
            assert rows.max() + most // 2 < 17
            # Rows are alike within 4.05 cm.
            assert (np.diff(rows) >= most + 2).all()
            assert reading.facts["depth_per_delay"] == pytest.approx(np.hypot(middle, 42.0) * 1480 / 0.3, rel=2e-3)


def test_the_line_of_snrs_is_the_one_that_paper_b_implies():
    modelled, paper = points(catalogue.study("long-range"))
    ranges = np.array([320.0, 400.0])
    np.testing.assert_allclose(paper.world.snr_at(paper.sonar, ranges), [-0.7, -6.4], atol=1e-9)
    assert modelled.world.snr_at(modelled.sonar, ranges)[1] == pytest.approx(-6.4, abs=0.01)


def test_the_table_has_depths_in_metres_and_the_bound_of_paper_b(run):
    table = run[0].table
    assert len(table) == 2 * 3 * 6
    row = table[(table.snr_profile.notna()) & (table.window == "5x9")].iloc[2]
    snr = 10 ** ((19.1075 - 0.07125 * (row.ground_range - 42)) / 10)
    per_delay = np.hypot(row.ground_range, 42.0) * 1480 / 0.3
    bound = per_delay / (2 * np.pi * 122e3) * np.sqrt((1 / snr + 0.5 / snr**2) / row.looks)
    # The two angles of view cost the rest: 1 - df / B with df = fc D H / (2 r^2).
    shift = 122e3 * 0.3 * 42 / (2 * (row.ground_range**2 + 42**2)) / 30e3
    gamma = snr / (1 + snr) * (1 - shift)
    with_shift = bound * np.sqrt((1 - gamma**2) / gamma**2 / (2 / snr + 1 / snr**2))
    assert row.depth_crlb == pytest.approx(with_shift, rel=3e-3)
    assert row.depth_std_in_wrap == pytest.approx(row.delay_std_in_wrap * per_delay, rel=3e-3)
    assert row.window_rows == 5


def test_an_estimator_may_be_limited_to_some_blocks(run):
    found, _ = run
    trials = found.table.groupby(["estimator", "window"]).trials.sum()
    assert trials["phase", "5x9"] == 2 * trials["correlation", "5x9"]
    assert found.missing[0] == 0
    assert found.differences.empty


def test_images_of_the_blocks_are_joined_along_track(strip, run):
    found, store = run
    for point, (_, images) in zip(points(strip), found.examples, strict=True):
        assert images["intensity"].shape == images["phase 5x9"].shape
        # 24 rows of 2 cm in cells of about 25 cm, two blocks.
        assert len(images["intensity"]) == 2
        assert images["row extent"] == pytest.approx([0.24])
        assert len(images["correlation 5x9"]) == 1
        again = echoes(task(strip, point, 1), 12, 2026)
        at = np.searchsorted(np.sqrt((again.grid.times * 740) ** 2 - 42.0**2), images["ground range"])
        np.testing.assert_array_equal(images["truth"][1], again.truth.height[11, at])
    assert store.read_traces(next(points(strip))).keys() == found.examples[0][1].keys()


def test_a_wrong_scene_is_told():
    with pytest.raises(ValueError, match=r"snr_profile is given beside a sediment or snr; it must be one of them"):
        Swath(ground_range=(42, 60), sediment="silt", snr_profile=((42, 1), (60, 0)))
    with pytest.raises(ValueError, match=r"ground_range is .* it must rise"):
        Swath(ground_range=(42, 60), snr_profile=((60, 1), (42, 0)))
    with pytest.raises(ValueError, match=r"sample_spacing is 0.025 m; it must be at most 0.02\d+ m to hold the regist"):
        plan(Scene((42.0, 60.0)), SONARS["hisas-1032"], sample_spacing=0.025)


def test_rows_from_any_number_on_and_samples_as_asked():
    sonar, scene = SONARS["hisas-1032"], Scene((100.0, 104.0))
    made = plan(scene, sonar, rows=4, row_spacing=0.02, sample_spacing=0.02)
    assert made.grid.sample_rate == pytest.approx(37e3)
    assert made.grid.period * made.grid.sample_rate == pytest.approx(made.grid.samples, abs=1e-9)
    whole, part = (
        simulate(scene, sonar, rng=np.random.default_rng(1), rows=rows, first_row=first, required=made)
        for rows, first in ((6, -2), (3, 1))
    )
    assert part.primary.tobytes() == whole.primary[3:].tobytes()


def test_pieces_of_a_record_give_the_delays_of_the_whole():
    sonar, scene = SONARS["hisas-1032"], Scene((100.0, 130.0))
    pair = simulate(scene, sonar, rng=np.random.default_rng(2), snr=15.0, rows=9, row_spacing=0.02)
    for window in (FixedWindow(9, 9), AdaptiveWindow(kappa=2.0, coherence=KnownCoherence(0.5), largest=9)):
        whole, pieces = (kind(window).estimate(pair).delay[4] for kind in (CrossCorrelation, CrossCorrelationInPieces))
        inside = slice(100, -100)
        assert pair.shape[1] > 1024
        # Ends 32 cells away: side lobes of 1 / (32 pi) of the amplitude, of random phases, over 9 looks and more.
        assert np.quantile(np.abs(whole - pieces)[inside], 0.99) * sonar.centre_frequency < 5e-3


def test_a_crossing_is_where_the_median_leaves_the_threshold():
    ground = np.arange(300.5, 380.5)
    spread = 0.3 + (ground - 300.5) * 0.01
    spread[10] = 5.0
    assert crossing(pd.Series(ground), pd.Series(spread)) == pytest.approx(321.0, abs=1.0)


def test_the_adaptive_window_is_that_of_paper_b_at_400_m():
    """39 x 39 pixels for the SNR that the paper implies; its expected STD is half the width, 39 cm."""
    sonar = SONARS["hisas-1032"]
    made = plan(Scene((398.0, 402.0)), sonar, rows=61, row_spacing=0.02, sample_spacing=0.02)
    profile = SnrProfile((320.0, 400.0), (-0.7, -6.4))
    pair = simulate(Scene((398.0, 402.0)), sonar, rng=np.random.default_rng(3), snr=profile, rows=61, required=made)
    rho = 10 ** (profile.at(400.0) / 10)
    window = AdaptiveWindow(kappa=2.0, coherence=KnownCoherence(float(rho / (1 + rho)))).on(replace(pair, truth=None))
    ground = pair.geometry.ground_range(pair.grid.times)
    rows = int(window.rows[np.nanargmin(np.abs(ground - 400.0))])
    assert abs(rows - 39) <= 2
    assert abs(rows * 0.02 / 2 - 0.39) <= 0.02
