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


NODES = np.polynomial.legendre.leggauss(300)


@given(st.floats(1.05, 1e6), st.floats(0.0, 1.0 - 1e-12))
@settings(max_examples=25, deadline=None)
def test_density_integrates_to_one(looks: float, coherence: float) -> None:
    x, w = NODES
    centre = np.arctanh(coherence)
    reach = 8.0 / np.sqrt(2.0 * looks)
    low, high = max(0.0, centre - reach - 20.0 / looks), centre + reach + 12.0 / (looks - 1.0)
    # Shares near one keep digits only up to zeta = 17; what lies beyond is at most exp(-2 (L - 1) (17 - zeta0)).
    high = min(high, 17.0)
    lost = np.exp(-2.0 * (looks - 1.0) * (17.0 - centre)) * (2.0 * looks if high == 17.0 else 0.0)
    span = 2.0 * np.arcsinh(0.5 * (high - low) / reach)
    zeta = 0.5 * (low + high) + reach * np.sinh(0.5 * span * x)
    jacobian = 0.5 * span * reach * np.cosh(0.5 * span * x)
    density = bounds.sample_coherence_pdf(np.tanh(zeta), looks, coherence)
    total = np.sum(w * jacobian * density / np.cosh(zeta) ** 2)
    # tanh rounds near one, by up to 2^-54: that moves the integral of a density that rises to f and falls by 2 f 2^-54
    # at the most. In zeta it is all but Gaussian with a spread of 1 / sqrt(2 L), so that f is sqrt(L / pi) cosh^2 zeta.
    rounding = 2.0**-53 * np.sqrt(looks / np.pi) * np.cosh(high) ** 2
    assert total == pytest.approx(1.0, abs=1e-6 + 4.0 * lost + rounding)


def test_known_limits() -> None:
    np.testing.assert_allclose(bounds.sample_coherence_mean(1e6, 0.0), np.sqrt(np.pi / 4e6), rtol=1e-6)
    np.testing.assert_allclose(bounds.sample_coherence_std(1e6, 0.5), 0.75 / np.sqrt(2e6), rtol=1e-6)
    np.testing.assert_equal(bounds.sample_coherence_mean([1.0, 9.0, 0.5], [0.3, 1.0, 0.5]), [1.0, 1.0, np.nan])


@pytest.mark.parametrize("looks", [1.001, 1.1, 1.7, 2.0, 9.0, 32.4, 777.0, 1e6])
def test_debiasing_inverts_the_mean(looks: float) -> None:
    g = np.concatenate([np.geomspace(1e-3, 0.1, 9), np.linspace(0.11, 0.99, 40), 1 - np.geomspace(1e-2, 1e-12, 10)])
    mean = bounds.sample_coherence_mean(looks, g)
    # Rounding of the mean is worth this much of a coherence near the floor.
    rounding = 2e-15 / (g**2 * min(looks - 1.0, 1.0))
    found = bounds.debias_coherence(mean, looks)
    assert np.all(np.abs(found / g - 1.0) < 1e-6 + rounding)
    assert np.all(np.diff(bounds.debias_coherence(np.linspace(0.0, 1.0, 1001), looks)) >= 0.0)


@given(st.floats(1.0001, 1e6), st.floats(1e-6, 1.0))
@settings(max_examples=40, deadline=None)
def test_debiasing_rises_with_the_sample_and_with_looks(looks: float, value: float) -> None:
    g = np.array([value, min(1.001 * value, 1.0), value])
    n = np.array([looks, looks, min(1.1 * looks, 1e6)])
    here, higher, more = bounds.debias_coherence(g, n)
    assert 0.0 <= here <= min(value * (1.0 + 1e-6), 1.0)
    assert higher >= here
    assert more >= here * (1.0 - 2e-6) - 1e-12


def test_long_range_reading_of_paper_b() -> None:
    # Theory section 6: a 9 x 9 window of 32.4 looks reads .231 for a true coherence of .187.
    assert bounds.debias_coherence(0.231, 32.4) == pytest.approx(0.187, abs=1e-3)
    np.testing.assert_equal(bounds.debias_coherence([-0.1, 0.05, 1.0, 1.1, np.nan], 9), [0, 0, 1, 1, np.nan])


@pytest.mark.parametrize(("looks", "coherence"), [(4.0, 0.7), (1.3, 0.9), (1.001, 1e-6), (1e6, 1.0 - 1e-12)])
def test_sampler_has_the_exact_moments(looks: float, coherence: float) -> None:
    rest = 1.0 - bounds.sample_sample_coherence(looks, coherence, rng=np.random.default_rng(5), size=200_000)
    mean, std = bounds.sample_coherence_mean(looks, coherence), bounds.sample_coherence_std(looks, coherence)
    # Five standard errors: false alarm 6e-7 for each moment, and the rounding of shares next to one.
    assert abs(rest.mean() - (1.0 - mean)) < 5.0 * std / np.sqrt(rest.size) + 1e-15
    square = rest**2
    expected = std**2 + (1.0 - mean) ** 2
    assert abs(square.mean() - expected) < 5.0 * square.std() / np.sqrt(rest.size) + 1e-15


def test_sampler_refuses_what_it_cannot_draw() -> None:
    rng = np.random.default_rng(1)
    np.testing.assert_equal(bounds.sample_sample_coherence(1, 0.3, rng=rng, size=3), [1.0, 1.0, 1.0])
    with pytest.raises(ValueError, match="looks is"):
        bounds.sample_sample_coherence(0.9, 0.3, rng=rng)
