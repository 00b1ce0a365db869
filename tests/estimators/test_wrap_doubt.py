"""The doubt of a wrap, read quickly, against every rival read in full."""

import numpy as np
import pytest
from scipy.special import hyp2f1

from estimators import FixedWindow, SplitSpectrum
from estimators.lag_product import lag_series
from estimators.peak_kernels import STENCIL
from estimators.wrap_doubt import doubt_of_a_guess, wrap_doubt
from estimators.wrap_doubt_kernels import CARE, _turns
from sim import speckle_pair

FC, B, RATE = 100e3, 30e3, 120e3
LAGS = 8


def read(stack, lag):
    """Lags and heights of the passband peaks next to lags, shape (time,), by polynomials through nine lags."""
    limit, turns_a_lag, time = stack.reach - STENCIL - 0.5, FC * stack.step, np.arange(lag.size)
    lag = np.clip(lag, -limit, limit)
    whole = np.rint(lag).astype(int)
    turns = np.angle(stack.products[whole + stack.reach, 0, time]) / (2 * np.pi) + turns_a_lag * whole
    # The nearest place where the turns of product and carrier together are whole.
    place = whole + (np.rint(turns + turns_a_lag * (lag - whole)) - turns) / turns_a_lag
    place = np.clip(place, -limit, limit)
    near = np.rint(place).astype(int)
    around = near + stack.reach + np.arange(-STENCIL, STENCIL + 1)[:, None]
    exponents = np.arange(2 * STENCIL + 1)
    powers = np.arange(-STENCIL, STENCIL + 1.0)[:, None] ** exponents
    coefficients = np.linalg.solve(powers, stack.products[around, 0, time])
    product = np.sum(coefficients * (place - near) ** exponents[:, None], axis=0)
    before, here, after = (stack.energies[near + stack.reach + step, 0, time] for step in (-1, 0, 1))
    share = place - near
    energy = here + share / 2 * (after - before) + share**2 / 2 * (after + before - 2 * here)
    energy = np.maximum(energy, np.minimum(here, np.minimum(before, after)))
    return place, np.minimum(np.abs(product) / energy, 1.0)


def test_phases_are_found_to_a_few_millionths_of_a_turn():
    for phase in np.linspace(-np.pi, np.pi, 999):
        off = _turns(3 * np.sin(phase), 3 * np.cos(phase)) - phase / (2 * np.pi)
        assert abs(off - round(off)) < 2e-6


def share(height, looks):
    """Of a wrap in the likelihood."""
    return 1 + hyp2f1(looks - 1, 0.5, 1, np.minimum(height, 1 - 1e-9) ** 2)


@pytest.mark.parametrize("coherence", [0.0, 0.5, 0.9, 0.99])
@pytest.mark.parametrize("samples", [12, 64, 400])
@pytest.mark.parametrize("at_peak", [True, False])
def test_rivals_left_out_matter_little(samples, coherence, at_peak):
    rng = np.random.default_rng([20261125, samples, round(100 * coherence)])
    pair = speckle_pair(
        (1, 800), coherence=coherence, delay=3.2 / RATE, centre_frequency=FC, bandwidth=B, sample_rate=RATE, rng=rng
    )
    window = FixedWindow(1, samples)
    reach = LAGS + STENCIL + 2
    stack = lag_series(pair.primary, pair.secondary, window, 2, reach, RATE).stack()
    looks, search = window.looks(pair), LAGS * stack.step
    middle = np.abs(stack.products[reach - LAGS : reach + LAGS + 1]).argmax(axis=0)[0] - LAGS
    lag = middle + 0.0 if at_peak else rng.uniform(-LAGS, LAGS, middle.size)
    found = wrap_doubt(stack, lag[None] * stack.step, looks, FC, search)[0]

    place, height = read(stack, lag)
    own = share(height, looks)
    wrap, odds = 1 / (FC * stack.step), np.zeros(lag.size)
    for away in range(-13, 14):
        part = np.minimum((LAGS - np.abs(lag + away * wrap)) / wrap + 0.5, 1.0) * (away != 0)
        odds += np.maximum(part, 0.0) * share(read(stack, place + away * wrap)[1], looks) / own
    plain = odds / (1 + odds)
    # None of the rivals beyond the nearest two that is left out has more than `CARE` of those.
    assert np.all(found <= (1 + 1e-3) * plain)
    assert np.all(found >= (1 - 1e-3 - CARE * (2 * LAGS / wrap - 2)) * plain)
    # The nearest ones alone are told better: most pixels need no others.
    assert np.median(np.abs(found / plain - 1)) < 3e-4


@pytest.mark.parametrize("wraps", [0.75, 1.0, 1.05, 6.67])
def test_a_guess_is_doubted_as_two_even_delays_are_apart(wraps):
    first, second = np.random.default_rng(11).uniform(0, wraps, (2, 400_000))
    rate = np.mean(np.abs(first - second) >= 0.5)
    # Five standard errors.
    assert doubt_of_a_guess(wraps) == pytest.approx(rate, abs=5 * np.sqrt(0.25 / 400_000))


def test_a_single_look_of_the_widest_band_is_not_sure():
    # 15 of 100 wraps were wrong and none claimed to be, as the range is narrower than a wrap.
    pair = speckle_pair(
        (200, 5),
        coherence=0.5,
        delay=0.0,
        centre_frequency=100e3,
        bandwidth=190e3,
        sample_rate=190e3,
        rng=np.random.default_rng(12),
    )
    estimate = SplitSpectrum(FixedWindow(1, 1)).estimate(pair)
    assert np.all(estimate.wrap_error_probability > 0.1)
