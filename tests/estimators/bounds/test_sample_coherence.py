import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import bounds


@pytest.mark.parametrize("looks", [1.001, 1.5, 2.0, 4.0, 16.0])
@pytest.mark.parametrize("coherence", [0.0, 1e-6, 0.5, 0.99])
def test_moments_and_density_equal_hypergeometric_forms(looks: float, coherence: float) -> None:
    with mpmath.workdps(40):
        n, g = mpmath.mpf(looks), mpmath.mpf(coherence)
        front = mpmath.gamma(n) * mpmath.gamma(1.5) / mpmath.gamma(n + 0.5) * (1 - g**2) ** n
        mean = front * mpmath.hyp3f2(1.5, n, n, n + 0.5, 1, g**2)
        square = 1 - (n - 1) / n * (1 - g**2) * mpmath.hyp2f1(1, 1, n + 1, g**2)
        std = mpmath.sqrt(square - mean**2)
        v = mpmath.mpf("0.7")
        pdf = 2 * (n - 1) * (1 - g**2) ** n * v * (1 - v**2) ** (n - 2) * mpmath.hyp2f1(n, n, 1, v**2 * g**2)
    assert bounds.sample_coherence_mean(looks, coherence) == pytest.approx(float(mean), rel=1e-9)
    assert bounds.sample_coherence_std(looks, coherence) == pytest.approx(float(std), rel=1e-8)
    assert bounds.sample_coherence_pdf(0.7, looks, coherence) == pytest.approx(float(pdf), rel=1e-7)


@given(st.floats(2.0, 1e6), st.floats(0.0, 1.0 - 1e-9))
@settings(max_examples=15, deadline=None)
def test_density_integrates_to_one(looks: float, coherence: float) -> None:
    x, w = np.polynomial.legendre.leggauss(400)
    centre = np.arctanh(coherence)
    low = np.arctanh(max(0.0, np.tanh(centre - 12.0 / np.sqrt(2.0 * looks))))
    high = min(centre + 12.0 / np.sqrt(2.0 * looks) + 14.0 / looks, 17.0)
    zeta = low + 0.5 * (high - low) * (x + 1.0)
    density = bounds.sample_coherence_pdf(np.tanh(zeta), looks, coherence)
    # tanh rounds near one, which limits the argument rather than the density.
    assert 0.5 * (high - low) * np.sum(w * density / np.cosh(zeta) ** 2) == pytest.approx(1.0, abs=1e-4)


def test_known_limits() -> None:
    np.testing.assert_allclose(bounds.sample_coherence_mean(1e6, 0.0), np.sqrt(np.pi / 4e6), rtol=1e-6)
    np.testing.assert_allclose(bounds.sample_coherence_std(1e6, 0.5), 0.75 / np.sqrt(2e6), rtol=1e-6)
    np.testing.assert_equal(bounds.sample_coherence_mean([1.0, 9.0, 0.5], [0.3, 1.0, 0.5]), [1.0, 1.0, np.nan])


@pytest.mark.parametrize("looks", [1.01, 2.0, 9.0, 32.4, 1e6])
def test_debiasing_inverts_the_mean(looks: float) -> None:
    g = np.concatenate(
        [[0.0], np.geomspace(1e-2, 0.1, 9), np.linspace(0.11, 0.99, 40), 1 - np.geomspace(1e-2, 1e-11, 9)]
    )
    back = bounds.debias_coherence(bounds.sample_coherence_mean(looks, g), looks)
    np.testing.assert_allclose(back, g, atol=1e-6)
    assert np.all(np.diff(bounds.debias_coherence(np.linspace(0.0, 1.0, 1001), looks)) >= 0.0)


def test_long_range_reading_of_paper_b() -> None:
    # Theory section 6: a 9 x 9 window of 32.4 looks reads .231 for a true coherence of .187.
    assert bounds.debias_coherence(0.231, 32.4) == pytest.approx(0.187, abs=1e-3)
    np.testing.assert_equal(bounds.debias_coherence([-0.1, 0.05, 1.0, 1.1, np.nan], 9), [0, 0, 1, 1, np.nan])


def test_sampler_has_the_exact_moments() -> None:
    draws = bounds.sample_sample_coherence(4, 0.7, rng=np.random.default_rng(5), size=200_000)
    error = float(bounds.sample_coherence_std(4, 0.7)) / np.sqrt(draws.size)
    # Five standard errors: false alarm 6e-7.
    assert abs(draws.mean() - 0.73751) < 5.0 * error + 5e-6
