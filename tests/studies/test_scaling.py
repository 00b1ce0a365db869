"""The tables of the study `scaling`; no time is asserted."""

import numpy as np
import pandas as pd
import pytest

from sim import SONARS
from studies import catalogue, engine
from studies.catalogue import scaling, scaling_stages
from studies.catalogue.scaling_stages import Sweep, n_log_n, spread


class Clock:
    """Tells time that only the work advances."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now

    def work(self, seconds):
        def case():
            self.now += seconds

        return case


def sweep(exponent, promised, variable="samples"):
    clock, sizes = Clock(), [1, 4, 16, 64, 256]
    cases = [_both(clock.work(1e-3 * (2 + n**exponent)), n) for n in sizes]
    return Sweep("made up", variable, sizes, cases, promised, None, clock)


def table_of(monkeypatch, *made):
    monkeypatch.setattr(scaling, "sweeps", lambda *given: iter(made))
    return scaling.measure(SONARS["hisas-100khz"], 1, np.random.default_rng(1))


@pytest.mark.parametrize(("exponent", "promised", "within"), [(1.0, 1, "yes"), (1.3, 1, "no"), (1.0, None, "")])
def test_known_costs_give_their_exponents(monkeypatch, exponent, promised, within):
    table = table_of(monkeypatch, sweep(exponent, promised))
    times = table[table.of == "time"]
    assert times.exponent.to_numpy() == pytest.approx(exponent, abs=1e-3)
    assert set(times.within) == {within}
    assert times.fixed.iloc[0] == pytest.approx(2e-3, rel=1e-2)
    np.testing.assert_allclose(times.fitted, times.cost, rtol=1e-3)
    assert (times.smallest.iloc[0], times.largest.iloc[0]) == pytest.approx((3e-3, 1e-3 * (2 + 256**exponent)))
    assert (table.of == "memory").sum() == 5


def test_memory_is_that_of_the_arrays(monkeypatch):
    sizes = [4**k for k in range(6, 11)]
    clock = Clock()
    made = Sweep("made up", "samples", sizes, [_both(clock.work(1e-3), n) for n in sizes], 0, 1, clock)
    table = table_of(monkeypatch, made)
    memory = table[table.of == "memory"]
    np.testing.assert_allclose(memory.cost, 8 * np.array(sizes), rtol=0.05)
    assert set(memory.within) == {"yes"}
    assert table[table.of == "time"].exponent.iloc[0] == pytest.approx(0.0, abs=1e-9)


def _both(work, n):
    def case():
        work()
        return np.zeros(n)

    return case


def test_every_stage_is_there_with_its_promise():
    """Their echoes are made, and nothing is timed."""
    made = list(scaling_stages.sweeps(SONARS["hisas-100khz"], 1, np.random.default_rng(1)))
    promised = {(one.stage, one.variable): one.time for one in made}
    assert promised["cross-correlation", "samples"] == promised["cross-correlation", "lags"] == 1
    assert promised["interferogram", "rows"] == promised["engine", "trials"] == 1
    assert promised["cross-correlation", "window in time"] == promised["interferogram", "window in time"] == 0
    memory = {(one.stage, one.variable): one.memory for one in made}
    assert memory["scene, in blocks of rows", "rows"] == memory["engine", "trials"] == 0
    for one in made:
        assert len(one.sizes) == len(one.cases)
        assert list(one.sizes) == sorted(set(one.sizes))
        # A factor of 16 where there is room for it.
        assert one.sizes[-1] >= 14 * one.sizes[0] or one.variable == "jobs"


def test_sizes_and_slopes():
    assert spread(1, 256, 5) == [1, 4, 16, 64, 256]
    sizes = np.geomspace(256, 65536, 9)
    local = np.polyfit(np.log(sizes), np.log(sizes * np.log(sizes)), 1)[0]
    assert n_log_n(sizes) == pytest.approx(local, abs=0.01)


def test_what_is_said_names_what_misses(monkeypatch):
    names = [
        ("cross-correlation", "samples", 1.0, 1),
        ("cross-correlation", "lags", 1.3, 1),
        ("cross-correlation", "window in time", 0.0, 0),
        ("interferogram", "rows", 1.0, 1),
        ("patch", "samples", 1.1, 1.1),
        ("engine", "trials", 1.0, 1),
        ("engine", "jobs", -1.0, -1),
    ]
    rows = [
        {"stage": stage, "variable": variable, "of": "time", "number": number, "size": size, "cost": size**exponent}
        | {"exponent": exponent, "exponent_se": 0.01, "promised": promised, "smallest": 1.0, "largest": 2.0**exponent}
        | {"fitted": size**exponent, "within": "yes" if abs(exponent - promised) <= 0.1 else "no"}
        for stage, variable, exponent, promised in names
        for number, size in enumerate([1.0, 2.0])
    ]
    table = pd.DataFrame(rows)
    said = scaling.answer(table)
    assert "6 of 7 promised exponents are found within 0.1" in said
    assert "not: time of cross-correlation over lags: 1.30 for 1.00" in said
    assert "2 jobs are 2.00 times as fast as one" in said
    assert len(scaling.times(table, []).axes) == 9


@pytest.mark.parametrize("name", ["scaling", "peers"])
def test_the_studies_are_checked(name):
    assert engine.check(catalogue.study(name)) == []
