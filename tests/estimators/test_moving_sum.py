import numpy as np
import pytest
import window_twin
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.moving_sum import product_sum, product_sum_within, window_sum

few = settings(max_examples=40, deadline=None)


@st.composite
def windows(draw):
    """An image, and a window that may have sizes of its own at every time, or hold all there is."""
    rows, times = draw(st.integers(1, 7)), draw(st.integers(1, 40))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))

    def size(most):
        kind = draw(st.sampled_from(["number", "varying", "whole"]))
        if kind == "varying":
            return rng.integers(1, most + 1, times)
        return most if kind == "whole" else draw(st.integers(1, most))

    # Whole numbers, so that every order of adding gives the same.
    shape = (2, rows, times)
    image = rng.integers(-99, 99, shape) + 1j * rng.integers(-99, 99, shape)
    return image, size(rows), size(times), draw(st.booleans())


@few
@given(windows(), st.sampled_from([np.complex128, np.complex64, np.float64, np.float32]))
def test_the_sum_is_that_of_the_pixels_in_the_window(case, kind):
    image, rows, samples, circular = case
    image = image.astype(kind) if np.issubdtype(kind, np.complexfloating) else image.real.astype(kind)
    found = window_sum(image, rows, samples, circular=circular)
    assert found.dtype in (np.float64, np.complex128)
    for plane, sums in zip(image, found, strict=True):
        twin = window_twin.window_sum(plane, rows, samples, circular)
        np.testing.assert_array_equal(np.broadcast_to(sums, plane.shape), twin)


@few
@given(windows(), st.sampled_from([np.complex128, np.complex64]))
def test_products_are_formed_and_summed(case, kind):
    image, rows, samples, circular = case
    first, second = image.astype(kind)
    found = product_sum(first, second, rows, samples, circular=circular)
    twin = window_twin.window_sum(first.conj().astype(complex) * second, rows, samples, circular)
    np.testing.assert_array_equal(np.broadcast_to(found, first.shape), twin)


@few
@given(windows(), st.integers(1, 7), st.integers(1, 12), st.integers(0, 3))
def test_products_are_summed_within_longer_rows(case, rows, samples, apart):
    first, second = case[0]
    times = first.shape[1]
    wide = [np.pad(series, ((0, 0), (samples, samples + apart)), mode="wrap") for series in (first, second)]
    found = np.empty(first.shape, dtype=np.complex128)
    product_sum_within(*wide, (samples, samples + apart), rows, samples, found)
    products = wide[0][:, : times + 2 * samples].conj() * wide[1][:, apart:]
    twin = window_twin.window_sum(products, rows, samples, False)[:, samples : samples + times]
    np.testing.assert_array_equal(found, twin)


def test_a_window_may_have_more_rows_than_the_image():
    image = np.arange(12.0).reshape(3, 4)
    np.testing.assert_array_equal(
        window_sum(image, 9, 1, circular=True), np.broadcast_to(image.sum(axis=0), image.shape)
    )


def away_from(centre, shape, rows, samples):
    r, t = np.indices(shape)
    inside = [(c - s + s // 2 < i) & (i <= c + s // 2) for c, i, s in zip(centre, (r, t), (rows, samples), strict=True)]
    return ~(inside[0] & inside[1])


@pytest.mark.parametrize(("rows", "samples"), [(1, 2), (3, 9), (9, 64), (20, 1)])
def test_a_pixel_160_db_brighter_leaves_no_trace_outside_its_windows(rows, samples):
    quiet = np.random.default_rng(1).normal(size=(40, 300))
    bright = quiet.copy()
    bright[20, 150] = 1e16
    away = away_from((20, 150), quiet.shape, rows, samples)
    sums, with_bright = (window_sum(image, rows, samples, circular=False) for image in (quiet, bright))
    np.testing.assert_array_equal(with_bright[away], sums[away])


@pytest.mark.parametrize("brightness", [1e8, 1e16])
def test_sizes_that_vary_leave_next_to_no_trace_of_a_bright_pixel(brightness):
    # Squared rounding units of what a block holds, for each of its numbers: (2^-53)^2 1e16 9 64 = 7e-14.
    quiet = np.random.default_rng(1).normal(size=(40, 300))
    bright = quiet.copy()
    bright[20, 150] = brightness
    rows, samples = 1 + np.arange(300) % 9, 1 + np.arange(300) * 7 % 64
    away = away_from((20, 150), quiet.shape, rows, samples)
    sums, with_bright = (window_sum(image, rows, samples, circular=False) for image in (quiet, bright))
    np.testing.assert_allclose(with_bright[away], sums[away], rtol=0, atol=brightness * 1e-29 + 1e-13)


@pytest.mark.parametrize(
    ("rows", "samples", "message"),
    [
        (0, 1, "rows has the value 0"),
        (1, 0, "samples has the value 0"),
        (1, 2.5, "samples has the value 2.5"),
        (1, 6, "samples is 6; it must not exceed the period, 5"),
        (np.ones(4, int), 1, "rows has the shape"),
        (1, np.array([1, 2, 3, 4, 6]), "samples is 6"),
    ],
)
def test_sizes_out_of_range_are_told(rows, samples, message):
    with pytest.raises(ValueError, match=message):
        window_sum(np.ones((3, 5)), rows, samples, circular=True)
