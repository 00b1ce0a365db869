"""Scenes of study files: what they become, what is said of wrong ones, and which errors are read of them."""

import dataclasses
import re
import shutil

import numpy as np
import pytest

from estimators import DelayEstimate, FixedWindow
from sim import (
    SEDIMENTS,
    SONARS,
    Box,
    EchoPair,
    HeightMap,
    PointTarget,
    Roughness,
    Scene,
    SedimentPatch,
    Slope,
    Step,
    TrawlMark,
    Truth,
    Wedge,
)
from studies import engine, manifest, report
from studies.design import points
from studies.scene_readings import clear
from studies.study import load
from studies.swath import Swath

GOOD = """
name = "mine"
question = "Which?"
[sonar]
preset = "hisas-1032"
[scene]
ground_range = ["60 m", 80]
sediment = "coarse sand"
scattering = "apl-uw"
speckle_shape = 5
row_spacing = "2 cm"
features = [
    { kind = "box", start = 62, width = "50 cm", height = 0.2, along_track = [-1, inf] },
    { kind = "wedge", start = 64, width = 1, height = 0.1 },
    { kind = "slope", start = 66, width = 1, rise = "-5 cm" },
    { kind = "step", ground_range = 68, rise = 0.1 },
    { kind = "trawl-mark", ground_range = 70, direction = "30 degrees" },
    { kind = "roughness", rms = "1 cm", seed = 4, period = 3.2 },
    { kind = "height-map", file = "map.npz" },
]
[scene.plan]
tolerance = 0.1
shadow = true
[[scene.patches]]
ground_range = [72, 74]
sediment = "silt"
[[scene.targets]]
ground_range = 75
level = "30 dB"
[[estimators]]
name = "cc"
method = "CrossCorrelation"
windows = [[3, 9]]
[trials]
count = 10
block = 10
"""

NODES = np.array([[0.0, 0.1, 0.0]])


@pytest.fixture
def study_file(tmp_path):
    np.savez(tmp_path / "map.npz", nodes=NODES, start=[0.0, 76.0], spacing=[1.0, 0.5])
    path = tmp_path / "mine.toml"
    path.write_text(GOOD)
    return path


def test_a_scene_is_what_its_file_says(study_file):
    scene = load(study_file).scene.scene()
    assert scene == dataclasses.replace(
        Scene(
            (60.0, 80.0),
            sediment=SEDIMENTS["coarse sand"],
            scattering="apl-uw",
            patches=[SedimentPatch((72.0, 74.0), "silt")],
            targets=[PointTarget(75.0, level=30.0)],
            speckle_shape=5.0,
        ),
        features=scene.features,
    )
    *known, read = scene.features
    assert known == [
        Box(62.0, 0.5, 0.2, (-1.0, np.inf)),
        Wedge(64.0, 1.0, 0.1),
        Slope(66.0, 1.0, -0.05),
        Step(68.0, 0.1),
        TrawlMark(70.0, 30.0),
        Roughness(0.01, 4, period=3.2),
    ]
    assert isinstance(read, HeightMap)
    assert (read.nodes.tolist(), read.start, read.spacing) == (NODES.tolist(), (0.0, 76.0), (1.0, 0.5))


def test_a_plan_is_what_its_file_says(study_file):
    swath = load(study_file).scene
    plan = swath.required(SONARS["hisas-1032"], 3)
    assert plan.shadow
    assert plan.along_track.spacing == 0.02
    # (.46 / .1)^(2/3)
    assert plan.scatterers_per_resolution == 3
    assert {d.name: d.reason for d in plan.decisions}["shadow"] == "as asked for"


@pytest.mark.parametrize(
    ("line", "by", "message"),
    [
        ('"trawl-mark"', '"trawlmark"', r"scene.features\[4\].kind = 'trawlmark': .* did you mean trawl-mark\?"),
        ('kind = "step", ', "", r"scene.features\[3\].kind is missing; it must be given"),
        ("rise = 0.1", "rice = 0.1", r"scene.features\[3\].rice: there is no such key; .* did you mean rise\?"),
        ('direction = "30', 'direktion = "30', r"scene.features\[4\].direktion: there .* did you mean direction\?"),
        (
            'direction = "30 deg',
            'direction = "30 g',
            r"scene.features\[4\].direction = '30 grees': its unit is 'grees'",
        ),
        ("start = 64", "start = -64", r"scene.features\[1\]: start is -64 m; it must be above 0 m"),
        ("seed = 4", "seed = -4", r"scene.features\[5\]: seed is -4; it must be a whole number of at least 0"),
        (
            '"map.npz"',
            '"nap.npz"',
            r"scene.features\[6\]: file is '.*nap.npz'; it must be one that can be read: No such",
        ),
        ('"map.npz"', '"mine.toml"', r"scene.features\[6\]: .*mine.toml holds no height map"),
        (
            'sediment = "silt"',
            'sediment = "sild"',
            r"scene.patches\[0\]: sediment is 'sild'; the closest names are silt",
        ),
        ("ground_range = 75", "ground_range = 85", "scene: .* leaves the scene; it must lie between 60 and 80 m"),
        ("speckle_shape = 5", "speckle_shape = 0", "scene.speckle_shape = 0: it must be greater than 0"),
        ('row_spacing = "2 cm"', "row_spacing = 0", "scene.row_spacing = 0: it must be greater than 0"),
        ("shadow = true", 'delays = "none"', "scene.plan.delays = 'none': it must be 'scatterers' or 'warp'"),
        ("shadow = true", 'level = "even"', "scene: plan.level is 'even'; it must be flat or local with a sediment"),
        ("shadow = true", "tolerants = 1", r"scene.plan.tolerants: there is no such key; .* did you mean tolerance\?"),
        ("speckle_shape = 5", "snr = 15", "scene: snr is 15 dB beside a sediment, whose levels follow; it must be one"),
    ],
)
def test_what_is_wrong_is_one_line(line, by, message, study_file):
    assert line in GOOD
    study_file.write_text(GOOD.replace(line, by))
    with pytest.raises(ValueError, match=f"^{re.escape(str(study_file))}: {message}") as found:
        load(study_file)
    assert "\n" not in str(found.value)


def test_a_warp_of_what_is_heard_at_once_is_found_before_a_run(study_file):
    study_file.write_text(GOOD.replace("shadow = true", 'delays = "warp"'))
    with pytest.raises(ValueError, match="delays is 'warp'; it must be 'scatterers'"):
        engine.check(load(study_file))


def test_what_a_height_map_holds_decides_the_echoes_and_not_where_it_lies(study_file):
    (before,) = points(load(study_file))
    moved = study_file.parent / "there"
    moved.mkdir()
    for name in ("mine.toml", "map.npz"):
        shutil.copy(study_file.parent / name, moved)
    (elsewhere,) = points(load(moved / "mine.toml"))
    assert elsewhere.key == before.key
    stored = manifest.plain(load(study_file))
    np.savez(study_file.parent / "map.npz", nodes=2 * NODES, start=[0.0, 76.0], spacing=[1.0, 0.5])
    (changed,) = points(load(study_file))
    assert changed.key != before.key
    assert changed.world.scene().heights[1] > before.world.scene().heights[1]
    with pytest.raises(ValueError, match=r"file is '.*map.npz' of digest \w{64}; it must have \w{64}"):
        engine.check(manifest.made(stored, "manifest"))


def pair_of(truth, *, looks=1.0, rows=6, samples=24):
    """A pair of noise with a truth; two samples in `1 / B`."""
    series = np.ones((rows, samples), dtype=complex)
    return EchoPair(series, series, 2.0, 10.0, 1.0, truth=truth, circular=True, row_spacing=1.0, row_looks=looks)


def estimate_of(delay):
    nothing = np.zeros(delay.shape)
    return DelayEstimate(delay, *[nothing] * 6, nothing == 0)


def truth_of(rows=6, samples=24):
    """Rows of a step along track: shadow in samples 8 and 9 of rows 3 to 5, and two parts in sample 20 of row 5."""
    delay = np.zeros((rows, samples))
    delay[3:, 8:10] = np.nan
    delay[5, 20] = np.nan
    branches = np.full((2, rows, samples), np.nan)
    branches[0] = np.where(np.isnan(delay), np.nan, delay)
    branches[:, 5, 20] = 0.3, -0.4
    layover = np.zeros((rows, samples), dtype=bool)
    layover[5, 20] = True
    shadow = np.isnan(delay) & ~layover
    return Truth(delay, height=delay, shadow=shadow, layover=layover, branches=branches)


SWATH = Swath(ground_range=(10.0, 20.0))


def test_errors_of_rows_that_differ_are_those_of_their_own_truth():
    pair = pair_of(truth_of())
    delay = np.full(pair.shape, 0.01)
    outside, layover = SWATH.read(pair, FixedWindow(1, 3), estimate_of(delay))
    # The window of 3, and two samples to either side: 3 of either side of what is hidden.
    expected = np.ones((6, 24), dtype=bool)
    expected[3:, 5:13] = False
    expected[5, 17:24] = False
    counted = np.zeros((6, 24), dtype=bool)
    counted[:, outside.samples] = outside.counted
    np.testing.assert_array_equal(counted, expected)
    np.testing.assert_array_equal(outside.errors[outside.counted], 0.01)
    # .01 is nearer to .3 than to -.4.
    assert layover.errors[layover.counted].tolist() == pytest.approx([-0.29])
    np.testing.assert_array_equal(layover.counted[:, 0], [False] * 5 + [True])


def test_windows_of_several_rows_keep_clear_of_what_other_rows_hide():
    seen = clear(pair_of(truth_of()), FixedWindow(3, 3))
    # Row 2 has row 3 in its window, row 1 has not.
    assert seen[1].all()
    assert not seen[2, 5:13].any()
    # With a resolution of two rows, row 0 has row 3 within its window and the resolution.
    assert not clear(pair_of(truth_of(), looks=0.5), FixedWindow(3, 3))[0, 5:13].any()


def test_rows_read_are_independent():
    truth = truth_of(rows=20)
    estimate = estimate_of(np.zeros((20, 24)))
    apart = {looks: SWATH.read(pair_of(truth, looks=looks, rows=20), FixedWindow(3, 3), estimate) for looks in (1, 0.4)}
    of_rows = {looks: np.arange(20)[readings[0].rows].tolist() for looks, readings in apart.items()}
    assert of_rows[1] == [1, 4, 7, 10, 13, 16]
    # Three rows of a window, and three of the resolution, 2.5 rows.
    assert of_rows[0.4] == [1, 7, 13]


def test_a_scene_with_sediment_is_measured_and_what_is_not_known_of_it_is_not_claimed(study_file):
    study = load(study_file)
    how, folder = engine.Run(jobs=1, backend="sequential"), study_file.parent / "out"
    engine.run(study, how, folder)
    table = report.result(study, engine.store_of(study, how.seed, folder)).table
    assert set(table.region) == {"outside", "layover"}
    outside = table.set_index("region").loc["outside"]
    assert outside.trials > 300
    assert outside.failures == 0
    assert outside.wrap_rate < 0.05
    for name in ("coherence", "snr_db", "predicted_wrap_rate", "predicted_delay_std", "crlb", "std_over_crlb"):
        assert np.isnan(outside[name])
