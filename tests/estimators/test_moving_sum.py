import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.moving_sum import circular_sum, clipped_sum


@st.composite
def cases(draw):
    samples = draw(st.integers(1, 60))
    length = draw(st.integers(1, samples))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return rng.normal(size=(2, samples)) + 1j * rng.normal(size=(2, samples)), length


@given(cases())
def test_circular_sum_equals_adding_the_samples_one_by_one(case):
    array, length = case
    samples = array.shape[1]
    plain = np.stack(
        [sum(array[:, (i - length // 2 + j) % samples] for j in range(length)) for i in range(samples)],
        axis=1,
    )
    np.testing.assert_allclose(np.broadcast_to(circular_sum(array, length), array.shape), plain, atol=1e-12)


@given(cases())
def test_clipped_sum_leaves_out_what_lies_beyond(case):
    array, length = case
    samples = array.shape[1]
    plain = np.stack(
        [array[:, max(i - length // 2, 0) : max(i - length // 2 + length, 0)].sum(axis=1) for i in range(samples)],
        axis=1,
    )
    np.testing.assert_allclose(clipped_sum(array, length, axis=-1), plain, atol=1e-12)
    np.testing.assert_allclose(clipped_sum(array.T, length, axis=0), plain.T, atol=1e-12)


@pytest.mark.parametrize("length", [2, 9, 64])
def test_a_pixel_160_db_brighter_leaves_no_trace_outside_its_windows(length):
    quiet = np.random.default_rng(1).normal(size=300)
    bright = quiet.copy()
    bright[150] = 1e16
    away = np.r_[0 : 150 - length, 150 + length : 300]
    np.testing.assert_array_equal(circular_sum(bright, length)[away], circular_sum(quiet, length)[away])
