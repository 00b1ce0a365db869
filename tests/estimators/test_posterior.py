"""The spread and the wrap errors that an estimate predicts for itself, against their definitions and against rates."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats
from scipy.special import logsumexp, stdtrit

from estimators import CrossCorrelation, FixedWindow, MaximumLikelihood, SplitSpectrum, bounds
from estimators.posterior import GUESS, NORMAL_95, beyond_edge, delay_std
from estimators.wrap_doubt import _mass_table
from estimators.wrap_doubt_kernels import log_share
from sim import speckle_pair

FC, B = 100e3, 30e3
SEED = 20261124


@pytest.mark.parametrize("looks", [3.5, 9, 33, 600])
@pytest.mark.parametrize("coherence", [0.95, 0.99, 0.9999])
def test_the_interval_of_a_phase_is_students(looks, coherence):
    # sin(phi) g sqrt(2N - 2) / sqrt(1 - g^2) is Student's t of 2N - 2 degrees of freedom, whatever the true coherence.
    sine = stdtrit(2 * looks - 2, 0.975) * np.sqrt((1 - coherence**2) / (2 * looks - 2)) / coherence
    found = delay_std(np.array([coherence]), looks, 0.3, refine=True)[0] * NORMAL_95
    # The likelihood has the cosine where the pivot has the sine: they part at second order.
    assert found == pytest.approx(np.arcsin(sine) / (2 * np.pi), rel=2e-3 + sine**2)


def test_many_looks_have_the_bounds():
    gamma = np.array([0.5, 0.9, 0.99])
    refined, group = (delay_std(gamma, 5000, 0.3, refine=refine) / FC for refine in (True, False))
    np.testing.assert_allclose(refined, bounds.phase_crlb(5000, gamma) / (2 * np.pi * FC), rtol=2e-3)
    np.testing.assert_allclose(group, bounds.group_delay_crlb(5000, gamma, B), rtol=2e-3)


@pytest.mark.parametrize("relative_bandwidth", [1e-3, 0.01, 0.3, 1.9])
@pytest.mark.parametrize("noise", [1e-2, 1e-4, 1e-6])
def test_narrow_bands_have_the_bound_near_full_coherence(relative_bandwidth, noise):
    # 1 - gamma^2 = noise^2, so that group delays of a narrow band fill the wrap until close to full coherence.
    gamma, band = np.array([np.sqrt(1 - noise**2)]), relative_bandwidth * FC
    bound = bounds.group_delay_crlb(33, gamma, band)[0] * FC
    found = delay_std(gamma, 33, relative_bandwidth, refine=False)[0]
    # Student's t of 64 degrees of freedom, 2 %, speckle's narrower spectrum, 3 %, and the steps of the table.
    assert found == pytest.approx(min(bound, GUESS / NORMAL_95), rel=0.08 if not 0.1 < bound < 0.4 else 0.3)


def test_full_coherence_claims_no_more_than_rounding_leaves():
    assert 0 < delay_std(np.ones(1), 33.0, 0.3, refine=True)[0] < 1e-8


def test_intervals_hold_at_60_db():
    pair, delay = patch(33, 1e6 / (1e6 + 1), 1000)
    pair = replace(pair, circular=False)
    estimate = CrossCorrelation(FixedWindow(1, 27)).estimate(pair)
    inside = np.abs(estimate.delay - delay[:, None])[:, 16] <= NORMAL_95 * estimate.delay_std[:, 16]
    # Five standard errors of a share of .95.
    assert inside.mean() > 0.95 - 5 * np.sqrt(0.95 * 0.05 / 1000)


@pytest.mark.parametrize("refine", [True, False])
def test_of_nothing_a_guess_is_left(refine):
    found = delay_std(np.array([0.0, 0.5]), 1.0, 0.3, refine=refine)
    np.testing.assert_allclose(found, GUESS / NORMAL_95)
    assert delay_std(np.array([0.0]), 9.0, 0.3, refine=refine)[0] == pytest.approx(GUESS / NORMAL_95, rel=1e-3)


def test_looks_may_differ_in_time():
    coherence = np.array([[0.5, 0.9, 0.7]])
    found = delay_std(coherence, np.array([9.0, 33.0, 9.0]), 0.3, refine=True)
    each = [delay_std(coherence[:, [i]], n, 0.3, refine=True)[0, 0] for i, n in enumerate((9.0, 33.0, 9.0))]
    np.testing.assert_array_equal(found[0], each)


@pytest.mark.parametrize("looks", [1.2, 2.0, 3.3, 9.0, 33.0, 600.0])
def test_the_share_of_a_wrap_is_the_hypergeometric_function(looks):
    for node in (10, 300, 500, 510):
        c = node / 512
        exact = float(mpmath.log(1 + mpmath.hyp2f1(looks - 1, 0.5, 1, c * c)))
        assert log_share(c, np.array([looks]), _mass_table(looks)[None], 0) == pytest.approx(exact, abs=1e-4)


def patch(looks, coherence, trials):
    rng = np.random.default_rng([SEED, looks, round(1000 * coherence)])
    delay = rng.uniform(-0.5, 0.5, trials) / FC
    pair = speckle_pair(
        (trials, looks), coherence=coherence, delay=delay, centre_frequency=FC, bandwidth=B, sample_rate=B, rng=rng
    )
    return pair, delay


def log_likelihood(looks):
    """Of a correlation, over its inverse hyperbolic tangent, with scales and coherence summed over by brute force.

    Of 2N real degrees of freedom with both scales integrated out, `(1 - g^2)^N int_0^inf (cosh w - g c)^-2N dw`
    (Fisher 1915); the prior of the coherence `g` is flat in the angle whose sine it is.
    """
    heights = np.linspace(-3.8, 3.8, 301)
    angle = (np.arange(400) + 0.5) / 400 * np.pi / 2
    w = np.concatenate([[0.0], np.geomspace(1e-3, 30.0, 400)])
    gamma_c = np.sin(angle)[:, None] * np.tanh(heights)
    # On the scale of the integrand at w = 0.
    ratio = np.log1p((np.cosh(w) - 1) / (1 - gamma_c[..., None]))
    inner = np.trapezoid(np.exp(-2 * looks * ratio), w, axis=-1)
    log = 2 * looks * (np.log(np.cos(angle))[:, None] - np.log1p(-gamma_c)) + np.log(inner)
    return heights, logsumexp(log, axis=0)


@pytest.mark.parametrize("looks", [5, 15, 81])
def test_the_integral_over_the_coherence_has_the_power_that_is_taken(looks):
    heights, log = log_likelihood(looks)
    high = heights > 1
    power = -np.polyfit(np.log1p(-(np.tanh(heights[high]) ** 2)), log[high], 1)[0]
    # Laplace's method is exact for many looks.
    assert power == pytest.approx(looks - 1, abs=0.15 / looks)


@pytest.mark.parametrize(
    ("looks", "coherence", "most", "typical"),
    [(5, 0.8, 0.15, 0.04), (15, 0.3, 0.15, 0.04), (33, 0.6, 0.05, 0.005), (81, 0.5, 0.05, 0.005)],
)
def test_the_doubt_is_the_integral_of_the_likelihood(looks, coherence, most, typical):
    """A plain sum of the definition over 128 delays a wrap, from the Fourier lines of whole records."""
    pair, _ = patch(looks, coherence, 300)
    estimate = MaximumLikelihood(FixedWindow(1, looks)).estimate(pair)
    primary, secondary = np.fft.fft(pair.primary), np.fft.fft(pair.secondary)
    energy = np.sqrt((np.abs(primary) ** 2).sum(axis=1) * (np.abs(secondary) ** 2).sum(axis=1))
    cycles = 1 + np.fft.fftfreq(looks, 1 / B) / FC
    search = FC / B
    delays = np.arange(-round(128 * search), round(128 * search) + 1) / 128
    cross = primary.conj() * secondary / energy[:, None]
    correlation = np.real(cross @ np.exp(2j * np.pi * np.outer(cycles, delays)))
    heights, log = log_likelihood(looks)
    read = np.interp(np.arctanh(np.clip(correlation, -0.999, 0.999)), heights, log)
    likelihood = np.exp(read - read.max(axis=1, keepdims=True))
    in_wrap = np.abs(delays - FC * estimate.delay[:, :1]) <= 0.5
    plain = 1 - (likelihood * in_wrap).sum(axis=1) / likelihood.sum(axis=1)
    # Away from the ends of the search, where a wrap is cut.
    inner = estimate.valid[:, 0] & (np.abs(FC * estimate.delay[:, 0]) < search - 0.5)
    assert inner.sum() > 100
    found = estimate.wrap_error_probability[:, 0]
    # As documented.
    assert np.abs(found - plain)[inner].max() < most
    assert np.median(np.abs(found - plain)[inner]) < typical


@pytest.mark.parametrize(
    ("method", "options"),
    [
        (MaximumLikelihood, {}),
        *((method, {"refine": refine}) for method in (CrossCorrelation, SplitSpectrum) for refine in (True, False)),
    ],
)
def test_95_per_cent_intervals_cover_93_to_97(method, options):
    # Of 3000 records 4.9 standard errors are .02, the false-alarm rate 1e-6 each.
    for looks, coherence in ((5, 0.9), (9, 0.5), (15, 0.7), (33, 0.9), (81, 0.3)):
        pair, delay = patch(looks, coherence, 3000)
        estimate = method(FixedWindow(1, looks), **options).estimate(pair)
        error = estimate.delay[:, 0] - delay
        right = np.abs(error) < 0.5 / FC
        coverage = (np.abs(error) <= NORMAL_95 * estimate.delay_std[:, 0])[right].mean()
        noise = 4.9 * np.sqrt(0.05 * 0.95 / right.sum())
        assert 0.93 - noise < coverage < 0.97 + noise, (looks, coherence)


def test_pixels_given_a_probability_fail_at_that_rate():
    claimed, wrong = [], []
    for looks in (5, 15, 45):
        for coherence in (0.1, 0.3, 0.5, 0.7, 0.9):
            pair, delay = patch(looks, coherence, 1500)
            estimate = CrossCorrelation(FixedWindow(1, looks)).estimate(pair)
            claimed.append(estimate.wrap_error_probability[:, 0])
            wrong.append(np.abs(estimate.delay[:, 0] - delay) > 0.5 / FC)
    claimed, wrong = np.concatenate(claimed), np.concatenate(wrong)
    for low, high in ((0, 0.01), (0.01, 0.05), (0.05, 0.15), (0.15, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.9)):
        here = (claimed >= low) & (claimed < high)
        said = claimed[here].mean()
        # 4.9 standard errors; the prior of the coherence is not that of this sweep, which may make 15 %.
        noise = 4.9 * np.sqrt(said * (1 - said) / here.sum())
        assert wrong[here].mean() == pytest.approx(said, abs=noise + 0.15 * said), (low, high)


def test_the_coherence_between_lags_does_not_exceed_that_of_the_echoes():
    # At .999 hardly any estimate of seven looks has a sample coherence of 1: an energy read too small would make it so.
    pair = speckle_pair(
        (20, 512),
        coherence=0.999,
        delay=0.3 / FC,
        centre_frequency=FC,
        bandwidth=B,
        sample_rate=4 / 3 * B,
        rng=np.random.default_rng(SEED),
    )
    estimate = CrossCorrelation(FixedWindow(1, 9)).estimate(pair)
    assert (estimate.coherence > 1 - 1e-6).mean() < 1e-3
    error = np.abs(estimate.delay - 0.3 / FC)
    assert (error <= NORMAL_95 * estimate.delay_std).mean() == pytest.approx(0.95, abs=0.02)


@settings(max_examples=60, deadline=None)
@given(st.floats(1.01, 2000.0), st.floats(0.0, 1.0 - 1e-9), st.floats(-np.pi, np.pi))
def test_the_tail_beyond_the_edge_is_that_of_students_t(looks, coherence, phase):
    freedom = 2 * (looks - 1)
    t = coherence * np.sin(min(np.pi - abs(phase), np.pi / 2)) * np.sqrt(freedom / (1 - coherence**2))
    expected = stats.t.sf(t, freedom)
    found = beyond_edge(np.full((1, 3), coherence), np.full((1, 3), phase), np.full(3, looks))
    np.testing.assert_allclose(found, expected, rtol=2e-4, atol=1e-29)
