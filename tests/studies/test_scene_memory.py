"""Scenes too large for memory are refused before they run."""

import tracemalloc

import numpy as np
import pytest

from sim import SONARS, Box, Scene, TrawlMark, plan, simulate
from studies import catalogue, engine, memory

SONAR = SONARS["hisas-1032"]


def test_a_block_that_does_not_fit_is_refused_in_one_line(monkeypatch):
    study = catalogue.study("box-scene")
    engine.check(study)
    monkeypatch.setattr(memory, "memory", lambda: 1e6)
    with pytest.raises(ValueError, match=r"^box-scene: a block of \d+ rows of \d+ samples takes .* GB; it must .*$"):
        engine.check(study)


def test_no_rows_are_looked_at_to_find_a_block_too_large():
    study = catalogue.study("long-range").with_values({"trials.block": 10**9, "trials.count": 10**9})
    with pytest.raises(ValueError, match=r"it must be below the .* GB of memory here: fewer trials\.block or a"):
        engine.check(study)


def test_the_memory_of_this_machine_is_known():
    assert 1e8 < memory.memory() < 1e15


@pytest.mark.parametrize("feature", [Box(70.0, 3.0, 1.0), TrawlMark(75.0, 30.0)])
def test_bytes_are_those_that_a_scene_takes(feature):
    """Within a third, of what numpy and numba ask for at once."""
    scene = Scene((60.0, 160.0), (feature,), sediment="sand")
    made = plan(scene, SONAR, rows=40)
    simulate(scene, SONAR, rng=np.random.default_rng(0), rows=1, required=made)
    tracemalloc.start()
    simulate(scene, SONAR, rng=np.random.default_rng(0), rows=40, required=made)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert sum(decision.bytes for decision in made.decisions) == pytest.approx(peak, rel=1 / 3)
