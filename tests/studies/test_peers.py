"""Peers and our methods on data without noise, where all must say the same; no time is asserted."""

import numpy as np
import pandas as pd
import pytest
from scipy.ndimage import uniform_filter

from estimators.even_table import read_even
from sim import SONARS
from studies.catalogue import peer_methods, peers

SONAR = SONARS["hisas-100khz"]


@pytest.fixture(scope="module")
def table():
    return peers.measure(SONAR, 4, np.random.default_rng(1))


def test_every_peer_has_a_row_with_what_is_asked_of_it(table):
    assert list(pd.unique(table.task)) == list(peers.UNITS)
    assert {"installed", "version", "microseconds", "times_ours", "error", "bias", "bias_se", "std_over_crlb"} <= set(
        table
    )
    there = table[table.installed]
    assert (there.microseconds > 0).all()
    assert (there.error >= 0).all()
    delays = there[there.task == "delay of a record"]
    assert delays.wrap_rate.between(0, 1).all()
    assert "takes" in peers.answer(table)


def test_a_peer_that_is_not_installed_is_left_out_and_said_so(monkeypatch):
    monkeypatch.setattr(peers, "installed", lambda method: not method.startswith("scikit"))
    table = peers.measure(SONAR, 1, np.random.default_rng(1))
    missing = table[~table.installed]
    assert len(missing) == 3
    assert missing.microseconds.isna().all()
    assert "Not installed: scikit-image phase_cross_correlation" in peers.answer(table)
    assert len(peers.figure(table, []).axes) == 4


def test_what_belongs_to_no_package_is_always_there():
    assert peers.installed("direct summation, exact")
    assert peers.version("matrix of paper A") == ""
    assert peers.version("scipy.signal oaconvolve").count(".") >= 2


def test_delays_without_noise_agree():
    """To 1e-5 wraps where four lags a resolution are interpolated, to a step of a hundredth of a sample otherwise."""
    rng = np.random.default_rng(2)
    delay = rng.uniform(-1.5, 1.5, 20) * SONAR.wrap
    pair = peer_methods.records(SONAR, (20, 64), 1.0, delay, rng)
    sample = 1 / pair.sample_rate
    for found in (peer_methods.cross_correlation(pair), peer_methods.maximum_likelihood(pair)):
        np.testing.assert_allclose(found, delay, rtol=0, atol=1e-5 * SONAR.wrap)
    np.testing.assert_allclose(peer_methods.resampled_peaks(pair), delay, rtol=0, atol=1e-2 * sample)
    found = peer_methods.scikit_image(pair, None)
    np.testing.assert_allclose(found, delay, rtol=0, atol=0.011 * sample)
    # The phase errs as the mean frequency of a record times the error of the delay; that is half the band at the most.
    most = 0.5 * SONAR.relative_bandwidth * 0.011
    np.testing.assert_allclose(peer_methods.with_phase(pair, found), delay, rtol=0, atol=most * sample)


def test_interferograms_agree():
    rng = np.random.default_rng(3)
    first, other = rng.normal(size=(2, 20, 30)) + 1j * rng.normal(size=(2, 20, 30))
    tiles = np.lib.stride_tricks.sliding_window_view(first.conj() * other, (9, 9)).sum(axis=(-2, -1))
    np.testing.assert_allclose(peer_methods.exact_interferogram(first, other), tiles, rtol=0, atol=1e-12 * 81)
    for found, scale in (
        (peer_methods.ours_interferogram(first, other), 1),
        (peer_methods.uniform_filters(first, other), 81),
        (peer_methods.convolved(first, other), 1),
    ):
        np.testing.assert_allclose(found[4:-4, 4:-4] * scale, tiles, rtol=0, atol=1e-12 * 81)
    assert uniform_filter(np.ones((9, 9)), 9, mode="constant")[4, 4] == pytest.approx(1.0)


def test_lag_products_and_echoes_agree_with_their_sums():
    rng = np.random.default_rng(4)
    primary, secondary = rng.normal(size=(2, 32)) + 1j * rng.normal(size=(2, 32))
    times, lags = [0, 7, 31], np.arange(-5, 6)
    exact = peer_methods.direct_lag_products(primary, secondary, times, lags)
    # At no delay the product of the samples themselves.
    np.testing.assert_allclose(exact[5], (primary.conj() * secondary)[times], rtol=1e-12)
    for found in (
        peer_methods.lag_products(primary, secondary, lags)[:, times],
        peer_methods.of_matrix(primary, secondary, times, lags),
    ):
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-11)
    band, at, strengths = peer_methods.scatterers(SONAR, 64, 40, rng)
    summed = peer_methods.direct_echoes(band, at, strengths)
    apart = band.grid.times[:, None] - at
    pulse = np.exp(2j * np.pi * band.frequencies[:, None, None] * apart)
    weights = np.sqrt(band.weights) / band.weights.sum()
    np.testing.assert_allclose(summed, (weights[:, None, None] * pulse).sum(axis=0) @ strengths, rtol=0, atol=1e-11)
    for accuracy in (2e-7, 1e-12):
        found = peer_methods.our_echoes(band, at, strengths, accuracy)
        assert np.linalg.norm(found - summed) < 10 * accuracy * np.linalg.norm(summed)


def test_an_even_table_is_read_as_numpy_reads_it():
    places = np.linspace(0.0, np.pi / 2, 129)
    values = np.cos(3 * places)
    x = np.array([[0.0, np.nextafter(0, 1), 0.3, places[7]], [places[-1], 1.6, np.inf, np.nan]])
    for beyond in (None, -np.inf):
        np.testing.assert_allclose(
            read_even(x, places, values, beyond), np.interp(x, places, values, right=beyond), rtol=0, atol=1e-13
        )
    assert read_even(np.array(0.3), places, values).shape == ()
