"""What is beaten in cost and error, and what calls cost."""

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studies.pareto import beaten_by
from studies.timing import Quartiles, in_turns, peak_bytes


def test_a_front_by_hand():
    cost = np.array([1.0, 2.0, 3.0, 4.0, 2.5, 5.0])
    error = np.array([9.0, 5.0, 5.0, 1.0, 4.0, 1.0])
    # 3.0 is beaten by 2.0 of the same error, and by 2.5; 5.0 by 4.0 of the same error.
    assert list(beaten_by(cost, error)) == [-1, -1, 1, -1, -1, 3]


def test_errors_differ_from_the_third_digit_on_only():
    assert list(beaten_by(np.array([1.0, 2.0]), np.array([1.0014, 1.0006]))) == [-1, 0]
    assert list(beaten_by(np.array([1.0, 2.0]), np.array([1.01, 1.00]))) == [-1, -1]


def test_what_has_no_number_neither_beats_nor_is_beaten():
    assert list(beaten_by(np.array([1.0, 2.0, np.nan]), np.array([np.nan, 1.0, 0.5]))) == [-1, -1, -1]


@given(st.lists(st.tuples(st.integers(1, 6), st.integers(0, 6)), min_size=1, max_size=12))
def test_a_plain_comparison_of_all_pairs_agrees(choices):
    cost, error = np.array(choices, dtype=float).T
    for place, found in enumerate(beaten_by(cost, error)):
        beating = [
            other
            for other in range(len(choices))
            if cost[other] <= cost[place]
            and error[other] <= error[place]
            and (cost[other] < cost[place] or error[other] < error[place])
        ]
        assert (found >= 0) == bool(beating)
        assert not beating or (found in beating and cost[found] == min(cost[other] for other in beating))
    assert (beaten_by(cost, error) < 0).any()


def busy(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


def test_cases_take_turns_after_one_call_each():
    calls = []
    cases = {name: lambda name=name: (calls.append(name), busy(0.005)) for name in "ab"}
    spent = in_turns(cases, repeats=3)
    assert calls == ["a", "b"] * 4
    assert {name: times.shape for name, times in spent.items()} == {"a": (3,), "b": (3,)}


def test_what_is_short_is_called_several_times_in_its_turn():
    calls = []
    spent = in_turns({"short": lambda: (calls.append("s"), busy(0.0005)), "long": lambda: busy(0.01)}, repeats=2)
    # Twice beforehand; 4 ms hold eight at the most, and a call that was held up fewer.
    assert 2 + 2 < len(calls) <= 2 + 2 * 8
    assert 0.0005 <= spent["short"].min() < 0.01 <= spent["long"].min()


def test_waiting_costs_nothing_and_work_does():
    spent = in_turns({"wait": lambda: time.sleep(0.002), "work": lambda: busy(0.02)}, repeats=1)
    assert spent["wait"][0] < 0.001 < 0.02 <= spent["work"][0]


def test_quartiles():
    assert Quartiles.of(np.array([5.0, 1.0, 2.0, 4.0, 3.0])) == (3.0, 2.0, 4.0)


def test_peak_memory_counts_what_is_held_at_once():
    def case():
        first = np.ones(2**20)
        second = first + 1  # 8 MiB each, at once
        del first
        return second[:1].copy()

    assert peak_bytes(case) == pytest.approx(2**24, rel=0.01)
