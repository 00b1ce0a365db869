"""A window that varies with time does at each time what a fixed one of that size does."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import METHODS as SHIPPED

from estimators import (
    CrossCorrelation,
    FixedWindow,
    Interferogram,
    TwoWindow,
)
from estimators.windows import VaryingWindow
from sim import EchoPair

METHODS = {**SHIPPED, "two-window-wide": lambda window: TwoWindow(CrossCorrelation(FixedWindow(3, 15)), window)}
TIMES = 40
SIZE = st.tuples(st.integers(1, 4), st.integers(1, 12))
FIELDS = ("delay", "phase", "coherence", "delay_std", "wrap_error_probability")


@st.composite
def varying(draw):
    """A window of at most three sizes, in runs of any length."""
    sizes = draw(st.lists(SIZE, min_size=1, max_size=3))
    which = np.array(draw(st.lists(st.integers(0, len(sizes) - 1), min_size=TIMES, max_size=TIMES)))
    rows, samples = np.array(sizes)[which].T
    return VaryingWindow(rows, samples)


def distinct(window):
    return {(int(r), int(s)) for r, s in zip(window.rows, window.samples, strict=True)}


def columns(window, size):
    return (window.rows == size[0]) & (window.samples == size[1])


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
@settings(max_examples=8, deadline=None)
@given(window=varying(), seed=st.integers(0, 2**32 - 1))
def test_every_estimator_gives_at_each_time_what_the_fixed_window_gives(make_patch, method, window, seed):
    pair = make_patch(5, TIMES, coherence=0.8, delay=0.4e-5, seed=seed)
    found = method(window).estimate(pair)
    for size in distinct(window):
        fixed, at = method(FixedWindow(*size)).estimate(pair), columns(window, size)
        np.testing.assert_array_equal(found.valid[:, at], fixed.valid[:, at])
        for name in FIELDS:
            here, there = (getattr(e, name)[:, at] for e in (found, fixed))
            if name == "phase":
                here, there = np.exp(1j * here), np.exp(1j * there)
            scale = 1e-5 if name.startswith("delay") else 1.0
            # The spread at a coherence of 1 is the root of its rounding, 1e-8 or so of 1 / B.
            scale *= 1e3 if name == "delay_std" else 1.0
            # Rivals are read at whole 128ths of a lag, to which rounding may take them one way or the other.
            rtol, atol = (0, 0.02) if name == "wrap_error_probability" else (1e-10, 1e-10 * scale)
            np.testing.assert_allclose(here, there, rtol=rtol, atol=atol, err_msg=name)


@given(window=varying(), seed=st.integers(0, 2**32 - 1), circular=st.booleans())
def test_sums_looks_and_borders_are_those_of_the_fixed_window(make_patch, window, seed, circular):
    pair = make_patch(5, TIMES, seed=seed, circular=circular)
    array = np.random.default_rng(seed).normal(size=(2, 5, TIMES))
    for size in distinct(window):
        fixed, at = FixedWindow(*size), columns(window, size)
        here, there = (np.broadcast_to(w.sum(array), array.shape)[..., at] for w in (window, fixed))
        np.testing.assert_allclose(here, there, rtol=0, atol=1e-13)
        np.testing.assert_array_equal(window.inside(pair)[:, at], fixed.inside(pair)[:, at])
        np.testing.assert_array_equal(window.looks(pair)[at], fixed.looks(pair))
    # What is not periodic is continued by zeros, and the last size with it.
    longer = np.pad(array, ((0, 0), (0, 0), (0, 7)))
    last = FixedWindow(int(window.rows[-1]), int(window.samples[-1]))
    np.testing.assert_allclose(window.sum(longer)[..., TIMES:], last.sum(longer)[..., TIMES:], rtol=0, atol=1e-13)


@pytest.mark.parametrize("size", [1, 2, 9])
def test_rows_that_are_alike_hold_as_many_looks_as_samples_that_are(make_patch, size):
    pair = make_patch(12, TIMES, oversampling=1.6)
    alike = replace(pair, row_looks=pair.bandwidth / pair.sample_rate)
    in_time = FixedWindow(1, size).looks(pair)
    assert FixedWindow(size, 1).looks(alike) == pytest.approx(in_time, rel=1e-12)
    assert FixedWindow(size, size).looks(alike) == pytest.approx(in_time**2, rel=1e-12)
    assert FixedWindow(size, 1).looks(pair) == pytest.approx(size, rel=1e-12)
    both = VaryingWindow(np.full(TIMES, size), np.ones(TIMES, dtype=int))
    np.testing.assert_allclose(both.looks(alike), in_time, rtol=1e-12)


@settings(max_examples=10, deadline=None)
@given(window=varying(), seed=st.integers(0, 2**32 - 1))
def test_a_record_that_is_not_periodic(make_patch, window, seed):
    pair = make_patch(5, TIMES, coherence=0.8, seed=seed, circular=False)
    found = Interferogram(window).estimate(pair)
    for size in distinct(window):
        fixed, at = Interferogram(FixedWindow(*size)).estimate(pair), columns(window, size)
        np.testing.assert_array_equal(found.valid[:, at], fixed.valid[:, at])
        np.testing.assert_allclose(found.delay[:, at], fixed.delay[:, at], atol=1e-17)
        np.testing.assert_allclose(found.coherence[:, at], fixed.coherence[:, at], atol=1e-12)


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_one_size_is_a_fixed_window(make_patch, method):
    pair = make_patch(5, TIMES, delay=0.4e-5)
    varies = method(VaryingWindow(np.full(TIMES, 3), np.full(TIMES, 9))).estimate(pair)
    fixed = method(FixedWindow(3, 9)).estimate(pair)
    np.testing.assert_allclose(varies.delay, fixed.delay, rtol=0, atol=1e-15)
    np.testing.assert_allclose(varies.quality, fixed.quality, rtol=0, atol=1e-10)


def test_a_large_window_is_not_brighter_than_a_small_one():
    # Series of one modulus: every pixel is as bright as the mean, so that quality is half of the coherence, 1.
    turn = np.exp(2j * np.pi * np.random.default_rng(1).uniform(size=(9, TIMES)))
    pair = EchoPair(turn, turn, 1.0, 2.0, 1.0, circular=True)
    rows = np.where(np.arange(TIMES) < 20, 3, 1)
    found = Interferogram(VaryingWindow(rows, 3 * rows)).estimate(pair)
    inner = found.quality[1:-1]
    np.testing.assert_allclose(inner / inner[0, 0], 1.0, rtol=1e-12)


def test_two_windows_that_both_vary(make_patch):
    pair = make_patch(5, TIMES, coherence=0.95, delay=0.4e-5)
    ones, step = np.ones(TIMES, dtype=int), np.where(np.arange(TIMES) < 20, 1, 3)
    wide = Interferogram(VaryingWindow(3 * ones, 7 * step))
    found = TwoWindow(wide, VaryingWindow(step, step)).estimate(pair)
    for size in (1, 3):
        fixed = TwoWindow(Interferogram(FixedWindow(3, 7 * size)), FixedWindow(size, size)).estimate(pair)
        np.testing.assert_allclose(found.delay_std[:, step == size], fixed.delay_std[:, step == size], rtol=1e-10)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: VaryingWindow([0, 3], [3, 3]), r"rows of the window are int64 of .*, 0 at the least; they must be .*"),
        (
            lambda: VaryingWindow([1, 3], [3.0, 3.0]),
            r"samples of the window are float64 of shape \(2,\), .*; they must be whole numbers .*",
        ),
        (lambda: VaryingWindow([1, 3], [3]), "the window has sizes for 2 and 1 times; it must be as many"),
    ],
)
def test_windows_that_cannot_be(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()


@pytest.mark.parametrize(
    ("window", "message"),
    [
        (VaryingWindow([1, 1], [3, 3]), "the window has sizes for 2 times; it must have them for all 40"),
        (VaryingWindow([6] * 40, [3] * 40), "the window has 6 rows; the pair has 5, and it must not have more"),
    ],
)
def test_windows_that_do_not_fit_the_pair(make_patch, window, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        Interferogram(window).estimate(replace(make_patch(5, TIMES), truth=None))


def test_sizes_that_cannot_be_are_refused_in_one_line():
    message = r"^rows of the window are int64 of shape \(100,\), 0 at the least; they must be whole numbers of at .*$"
    with pytest.raises(ValueError, match=message):
        VaryingWindow(np.zeros(100, int), np.ones(100, int))
