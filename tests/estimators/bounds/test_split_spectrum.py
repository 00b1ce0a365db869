import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from estimators import bounds

LOOKS = st.floats(3.0, 3e6)
COHERENCE = st.floats(1e-6, 1.0 - 1e-12)
RATIO = st.floats(1e-4, 1.9)


def twin(sub_looks: float, coherence: float, threshold: float) -> float:
    """Density of one phase times the chance that the other is not within the threshold of it."""
    scale = min(float(bounds.phase_crlb(sub_looks, coherence)), 1.0)
    offsets = np.concatenate([[0.0], np.geomspace(0.1 * scale, np.pi, 60)])
    edges = np.concatenate([c + s * offsets for c in (0.0, threshold, np.pi - threshold, np.pi) for s in (-1.0, 1.0)])
    edges = np.unique(np.clip(edges, 0.0, np.pi))
    x, w = np.polynomial.legendre.leggauss(12)
    phase = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (x + 1.0)).ravel()
    weight = (0.5 * np.diff(edges)[:, None] * w).ravel()
    outside = bounds.multilook_phase_cdf(phase - threshold, sub_looks, coherence)
    turned = phase + threshold > np.pi
    above = np.where(turned, phase + threshold - 2.0 * np.pi, -phase - threshold)
    outside = outside + np.where(turned, -1.0, 1.0) * bounds.multilook_phase_cdf(above, sub_looks, coherence)
    return float(2.0 * np.sum(weight * bounds.multilook_phase_pdf(phase, sub_looks, coherence) * outside))


@pytest.mark.parametrize("ratio", [1e-4, 0.3, 1.2, 1.499])
@pytest.mark.parametrize("sub_looks", [1.0, 1.3, 4.0, 32.4, 1e6])
def test_rate_is_a_convolution_of_two_phases(sub_looks: float, ratio: float) -> None:
    for coherence in (1e-6, 0.3, 0.9, 1.0 - 1e-6, 1.0 - 1e-12):
        expected = twin(sub_looks, coherence, np.pi * ratio * 2.0 / 3.0)
        found = float(bounds.split_spectrum_wrap_error_probability(3.0 * sub_looks, coherence, ratio))
        if expected > 1e-250:
            assert found == pytest.approx(expected, rel=1e-6)
        else:
            assert 0.0 <= found < 1e-249


def test_sub_band_share_and_simulation() -> None:
    rng = np.random.default_rng(11)
    for n, g, ratio, share in ((9, 0.9, 0.3, 1 / 3), (81, 0.5, 0.3, 1 / 3), (4, 0.9, 1.2, 1 / 3), (9, 0.7, 0.5, 0.5)):
        power, noise = rng.gamma(n * share, size=(2, 200_000)), rng.standard_normal((2, 200_000, 2)) @ [1, 1j]
        signal = g * np.sqrt(power) + np.sqrt((1 - g**2) / 2) * noise
        p = np.mean(np.abs(np.angle(signal[0] * signal[1].conj())) > np.pi * ratio * (1 - share))
        found = bounds.split_spectrum_wrap_error_probability(n, g, ratio, sub_band_share=share)
        # Five standard errors: false alarm 6e-7 for each point.
        assert abs(found - p) < 5.0 * np.sqrt(p * (1 - p) / 200_000)


@given(LOOKS, COHERENCE, RATIO)
@settings(max_examples=40, deadline=None)
def test_rate_falls_with_looks_coherence_and_bandwidth(looks: float, coherence: float, ratio: float) -> None:
    n = np.array([looks, 1.1 * looks, looks, looks])
    g = np.array([coherence, coherence, 0.5 * (1.0 + coherence), coherence])
    here, *better = bounds.split_spectrum_wrap_error_probability(n, g, ratio * np.array([1.0, 1.0, 1.0, 1.05]))
    assert 0.0 <= here <= 1.0
    assert np.all(np.array(better) <= here * (1.0 + 1e-7))


def test_gaussian_approximation() -> None:
    # Many looks and a small threshold make the phases as good as Gaussian.
    g = np.array([0.01, 0.02])
    exact = bounds.split_spectrum_wrap_error_probability(3e6, g, 0.05)
    np.testing.assert_allclose(bounds.gaussian_split_spectrum_wrap_error_probability(3e6, g, 0.05), exact, rtol=5e-3)
    d = 0.5 / 100e3 / bounds.split_spectrum_crlb(90, 0.5, 30e3, 10e3)
    rate = bounds.gaussian_split_spectrum_wrap_error_probability(90, 0.5, 0.3)
    assert rate == pytest.approx(2.0 * norm.sf(d), rel=1e-12)


def test_limits_and_validity() -> None:
    rate = bounds.split_spectrum_wrap_error_probability(
        [3.0, 9.0, 9.0, 9.0], [0.0, 0.0, 1.0, 0.5], [0.3, 1.2, 0.3, 1.5]
    )
    np.testing.assert_allclose(rate, [0.8, 0.2, 0.0, 0.0], rtol=1e-12)
    bad = bounds.split_spectrum_wrap_error_probability([2.9, 9.0, 9.0, 9.0], [0.5, 1.1, 0.5, 0.5], [0.3, 0.3, 0.0, 2.0])
    assert np.all(np.isnan(bad))
    assert np.isfinite(bounds.split_spectrum_wrap_error_probability(3.0, 0.5, 0.3))
    with pytest.raises(ValueError, match=r"sub_band_share is 0\.6"):
        bounds.split_spectrum_wrap_error_probability(9, 0.5, 0.3, sub_band_share=0.6)
