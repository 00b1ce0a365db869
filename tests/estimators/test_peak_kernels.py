import numpy as np
import window_twin
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import FixedWindow
from estimators.lag_product import LagStack, lag_series
from estimators.peak import moved_to, peak_at

few = settings(max_examples=30, deadline=None)


@few
@given(st.integers(1, 3), st.integers(1, 70), st.integers(0, 2**32 - 1), st.booleans())
def test_peaks_are_climbed_as_by_a_plain_polynomial(rows, times, seed, smooth):
    rng = np.random.default_rng(seed)
    shape = (21, rows, times)
    products = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    if smooth:
        lags = np.arange(21)[:, None, None]
        place, turn = rng.uniform(6, 14, shape[1:]), rng.uniform(-1, 1, shape[1:])
        products = np.sinc((lags - place) / 4) * np.exp(1j * turn * lags) + 1e-3 * products
    energies = np.abs(products) + rng.uniform(0, 1, shape)
    index = (np.abs(products[4:-4]) ** 2).argmax(axis=0) + 4
    peak = peak_at(LagStack(products, energies, 0.5), index)
    for r, t in np.ndindex(rows, times):
        share, product, energy, inside = window_twin.peak(products[:, r, t], energies[:, r, t], index[r, t])
        assert peak.inside[r, t] == inside
        np.testing.assert_allclose(peak.delay[r, t], (index[r, t] - 10 + share) * 0.5, atol=1e-9)
        np.testing.assert_allclose(peak.product[r, t], product, atol=1e-8)
        np.testing.assert_allclose(peak.energy[r, t], energy, atol=1e-8)


def test_a_stack_of_one_time_is_read_at_all():
    rng = np.random.default_rng(4)
    products = rng.normal(size=(15, 2, 1)) + 1j * rng.normal(size=(15, 2, 1))
    stack = LagStack(products, np.abs(products), 1.0)
    spread = LagStack(np.repeat(products, 600, axis=2), np.abs(np.repeat(products, 600, axis=2)), 1.0)
    delay = rng.uniform(-3, 3, (2, 600))
    unread = peak_at(spread, np.full((2, 600), 7))
    for one, other in zip(moved_to(unread, stack, delay), moved_to(unread, spread, delay), strict=True):
        np.testing.assert_array_equal(one, other)


@few
@given(st.integers(9, 60), st.integers(1, 9), st.integers(0, 2**32 - 1))
def test_the_stack_holds_the_products_at_whole_samples(times, samples, seed):
    rng = np.random.default_rng(seed)
    primary, secondary = rng.normal(size=(2, times)) + 1j * rng.normal(size=(2, times))
    stack = lag_series(primary[None], secondary[None], FixedWindow(1, samples), 1, 4, 1.0).stack()
    twin = window_twin.lag_products(primary, secondary, 2 * np.arange(-4, 5), samples)
    np.testing.assert_allclose(np.broadcast_to(stack.products[:, 0], twin.shape), twin, atol=1e-11)
    assert np.all(np.abs(stack.products) <= stack.energies * (1 + 1e-12))
