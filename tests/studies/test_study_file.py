"""Study files: what they hold, and what is said of one that is wrong."""

import copy
import re
import tomllib
from functools import reduce
from operator import getitem

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import SONARS, Box, Wedge
from studies import catalogue, engine
from studies.design import methods, points
from studies.study import Study, load, made

GOOD = """
name = "mine"
question = "Which?"
[sonar]
preset = "hisas-100khz"
[patch]
looks = 9
snr = "10 dB"
[[estimators]]
name = "cc"
method = "CrossCorrelation"
[trials]
count = 100
block = 50
"""


def changed(text, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", catalogue.NAMES)
def test_shipped_studies_are_files_that_can_be_copied(name, tmp_path):
    copied = changed(catalogue.path_of(name).read_text(), tmp_path)
    assert load(copied) == catalogue.study(name)
    study = load(copied).for_a_first_look()
    assert len(engine.check(study)) > 1 or not study.simulates


@pytest.mark.parametrize(
    ("line", "by", "message"),
    [
        ("looks = 9", "lokks = 9", "patch.lokks: there is no such key; .* did you mean looks?"),
        ("looks = 9", "looks = 2", "patch.looks = 2: it must be greater than or equal to 3"),
        ("looks = 9", 'looks = "many"', "patch.looks = 'many': it must be a whole number$"),
        ("looks = 9", "looks = 9.5", "patch.looks = 9.5: it must be a whole number$"),
        ('question = "Which?"', "question = 3", "question = 3: it must be text$"),
        ("count = 100", "count = 1e30", r"trials.count = 1e\+30: it must be a whole number$"),
        ('name = "cc"', 'name = "c/c"', r"estimators\[0\].name = 'c/c': it must be letters, digits, spaces and any"),
        (
            'name = "cc"',
            'name = "cc"\nwindows = []',
            r"estimators\[0\].windows = \[\]: it has 0 values; it must have at l",
        ),
        ('name = "cc"', 'name = "cc"\nwindows = "record"', r"estimators\[0\].windows = 'record': it must be a list$"),
        ('name = "cc"', 'name = "cc"\noptions = 3', r"estimators\[0\].options = 3: it must be a table$"),
        (
            'name = "cc"',
            'name = "cc"\noptions = { search = [1] }',
            r"estimators\[0\].options.search = \[1\]: it must be true or false or a whole number or a number or text$",
        ),
        ('snr = "10 dB"', 'snr = "10 Hz"', "patch.snr = '10 Hz': its unit is 'Hz'; it must be one of dB"),
        ('snr = "10 dB"', 'snr = "loud"', "patch.snr = 'loud': it must be a number in dB"),
        ('snr = "10 dB"', "", "patch: snr and coherence are both given or both missing; it must be one of them"),
        ('snr = "10 dB"', "coherence = 1.5", "patch.coherence = 1.5: it must be less than or equal to 1"),
        ("count = 100", "count = 0", "trials.count = 0: it must be greater than or equal to 1"),
        ("block = 50", "", "trials.block is missing; it must be given"),
        ('question = "Which?"', "", "question is missing; it must be given"),
        ('name = "mine"', 'name = "My study"', "name = 'My study': it must be lower-case letters, digits and hyphens"),
        ("[trials]", "[trail]", "trail: there is no such key; .* did you mean trials?"),
        (
            "block = 50",
            "block = 50\n[trials.until]",
            "trials.until: no target is given; it must be some of wrap_errors",
        ),
        ('name = "cc"', 'name = "cc"\nwindows = [[0, 3]]', r"estimators\[0\].windows\[0\] = \[0, 3\]: it must be 'rec"),
        (
            "block = 50",
            "block = 50\n[scene]\nground_range = [1, 2]",
            "patch and scene of patch, scene, levels, plans, experiment is given",
        ),
        (
            "[trials]",
            '[[axes]]\n"patch.looks" = [9, 33]\n"patch.snr" = [1]\n[trials]',
            "axes has {'patch.looks': 2, 'patch.snr': 1} values; keys that vary together must have as many",
        ),
        ("[trials]", '[[axes]]\n"patch.look" = [9]\n[trials]', "axes has 'patch.look'; .* did you mean patch.looks?"),
    ],
)
def test_what_is_wrong_is_one_line_with_file_key_value_and_what_is_allowed(line, by, message, tmp_path):
    assert line in GOOD
    path = changed(GOOD.replace(line, by), tmp_path)
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: {message}") as found:
        load(path)
    assert "\n" not in str(found.value)


@pytest.mark.parametrize(
    ("line", "by", "message"),
    [
        ('preset = "hisas-100khz"', 'preset = "hisas"', "sonar.preset = 'hisas': it must be one of hisas-100khz, "),
        (
            'preset = "hisas-100khz"',
            'bandwidth = "30 kHz"',
            "mine: sonar: centre_frequency is missing; it must be given",
        ),
        (
            'preset = "hisas-100khz"',
            'preset = "hisas-100khz"\nbandwidth = -3e4',
            "mine: sonar: bandwidth is -30000 Hz; it must be above 0 Hz",
        ),
        (
            'method = "CrossCorrelation"',
            'method = "CrossCorelation"',
            "method is 'CrossCorelation'; .* did you mean Cro",
        ),
        ('method = "CrossCorrelation"', 'method = "no.such:thing"', "method is 'no.such:thing'; it must be an object"),
        (
            'method = "CrossCorrelation"',
            'method = "CrossCorrelation"\noptions = { serach = 1e-5 }',
            "option serach is not one of CrossCorrelation; it must be one of refine, search, .* did you mean search?",
        ),
        (
            'method = "CrossCorrelation"',
            'method = "CrossCorrelation"\nwindows = [[1, 10]]',
            "mine: a window of cc has 10 samples; a block of the echoes has 9, and it must not have more",
        ),
        ("[trials]", '[[axes]]\n"patch.looks" = [9, 1]\n[trials]', "mine: patch.looks = 1: it must be greater than"),
    ],
)
def test_what_cannot_be_run_is_found_before_it_is(line, by, message, tmp_path):
    path = changed(GOOD.replace(line, by), tmp_path)
    with pytest.raises(ValueError, match=message) as found:
        engine.check(load(path))
    assert "\n" not in str(found.value)


def test_units_are_read():
    tree = tomllib.loads(GOOD)
    tree["sonar"] |= {"centre_frequency": "0.12 MHz", "bandwidth": 4e4, "baseline": "25 cm"}
    sonar = next(points(made(tree, "x"))).sonar
    assert (sonar.centre_frequency, sonar.bandwidth, sonar.baseline) == (120e3, 40e3, 0.25)
    assert sonar.altitude == SONARS["hisas-100khz"].altitude


def test_axes_are_a_grid_of_groups_and_further_points():
    tree = tomllib.loads(GOOD)
    tree["axes"] = [{"patch.looks": [9, 33], "sonar.bandwidth": [1e4, 3e4]}, {"patch.snr": [0, 10, 20]}]
    tree["points"] = [{"patch.looks": 5, "patch.snr": 3}, {"patch.looks": 9, "patch.snr": 0, "sonar.bandwidth": 1e4}]
    found = list(points(made(tree, "x")))
    expected = [(looks, width, snr) for looks, width in ((9, 1e4), (33, 3e4)) for snr in (0, 10, 20)]
    # The last point is one of the grid and counts once.
    expected += [(5, 30e3, 3)]
    assert [(p.world.looks, p.sonar.bandwidth, p.world.snr) for p in found] == expected
    assert [p.number for p in found] == list(range(7))
    assert found[1].columns == {"looks": 9, "bandwidth": 1e4, "snr": 10}


def test_a_point_varied_in_coherence_replaces_the_snr():
    tree = tomllib.loads(GOOD)
    tree["axes"] = [{"patch.coherence": [0.5, 1.0]}]
    assert [p.world.true_coherence for p in points(made(tree, "x"))] == [0.5, 1.0]


def test_features_of_a_scene():
    scene = catalogue.study("box-scene").scene.scene()
    assert scene.features[0] == Box(35.0, 5.0, 2.0)
    assert scene.features[-1] == Wedge(165.0, 20.0, 2.0)


def test_values_can_be_replaced_by_key():
    study = made(tomllib.loads(GOOD), "x").with_values({"patch.looks": 33, "trials.until.wrap_errors": 5})
    assert study.patch.looks == 33
    assert study.trials.until.wrap_errors == 5
    with pytest.raises(ValueError, match=r"there is no 'patch.lok' in mine; .* did you mean patch.looks\?"):
        study.with_values({"patch.lok": 3})


def test_the_same_objects_in_python(tmp_path):
    study = Study(
        name="mine",
        question="Which?",
        sonar={"preset": "hisas-100khz"},
        patch={"looks": 9, "snr": 10},
        estimators=[{"name": "cc", "method": "CrossCorrelation"}],
        trials={"count": 100, "block": 50},
    )
    assert study == load(changed(GOOD, tmp_path))


class Noisy:
    """An estimator with random numbers of its own."""

    def __init__(self, window, rng):
        self.window, self.rng = window, rng

    def estimate(self, pair):
        from estimators import Interferogram

        found = Interferogram(self.window).estimate(pair)
        return type(found)(found.delay + self.rng.normal(0, 1e-8, pair.shape), *list(vars(found).values())[1:])


def test_an_estimator_of_ones_own_has_a_stream_of_its_own(tmp_path, table_of):
    tree = tomllib.loads(GOOD)
    tree["estimators"] = [
        {"name": name, "method": method}
        for name, method in (
            ("noisy", f"{__name__}:Noisy"),
            ("also", f"{__name__}:Noisy"),
            ("cc", "CrossCorrelation"),
        )
    ]
    how = engine.Run(jobs=1, backend="sequential")
    table = table_of(made(tree, "x"), how, tmp_path / "three").set_index("estimator")
    tree["estimators"] = tree["estimators"][:1]
    alone = table_of(made(tree, "x"), how, tmp_path / "one").set_index("estimator")
    assert table.rmse["noisy"] == alone.rmse["noisy"]
    assert table.rmse["noisy"] != table.rmse["also"]
    assert methods(made(tree, "x"), next(points(made(tree, "x"))))[0].stream() > 0
    assert np.isfinite(table.rmse).all()


VALUES = st.recursive(
    st.one_of(st.booleans(), st.integers(), st.floats(), st.text(max_size=3)),
    lambda inner: st.one_of(st.lists(inner, max_size=2), st.dictionaries(st.text(max_size=3), inner, max_size=2)),
    max_leaves=3,
)
WHOLE = {
    **tomllib.loads(GOOD),
    "axes": [{"patch.looks": [9, 33]}],
    "points": [{"patch.looks": 9}],
    "figures": [{"name": "one", "x": "looks", "y": "rmse", "limits": [0, 1]}],
    "summary": {"columns": ["looks"], "where": {"looks": 9}},
    "quick": {"trials.count": 3},
}


def places(tree, *before):
    """The keys and numbers that lead to every value of a tree."""
    if before:
        yield before
    for step, inner in tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ():
        yield from places(inner, *before, step)


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(list(places(WHOLE))), VALUES)
def test_no_value_is_refused_in_the_words_of_a_library(place, value):
    tree = copy.deepcopy(WHOLE)
    *path, last = place
    reduce(getitem, path, tree)[last] = value
    try:
        made(tree, "mine")
    except ValueError as error:
        said = str(error)
        assert said.startswith("mine: ")
        assert "\n" not in said
        assert not re.search(
            r"Input|[Vv]alid|[Ss]tring|Tuple|Dictionary|Unable|validation|instance", said.split(": ", 2)[-1]
        )
