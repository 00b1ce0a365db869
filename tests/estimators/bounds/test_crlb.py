import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import bounds

LOOKS = st.floats(1.0, 1e6)
COHERENCE = st.floats(1e-6, 1.0 - 1e-12)
RATIO = st.floats(1e-4, 1.9)


@pytest.mark.parametrize("ratio", [1e-4, 0.3, 1.9])
@pytest.mark.parametrize("coherence", [1e-8, 1e-6, 0.3, 0.9, 1.0 - 1e-12])
@pytest.mark.parametrize("looks", [1.0, 9.5, 1e6])
def test_bounds_equal_their_formulas_at_high_precision(looks: float, coherence: float, ratio: float) -> None:
    band = 100e3 * ratio
    with mpmath.workdps(40):
        n, g, fc, b = mpmath.mpf(looks), mpmath.mpf(coherence), mpmath.mpf(100e3), mpmath.mpf(band)
        root = mpmath.sqrt((1 - g**2) / (2 * n * g**2))
        intensity = mpmath.sqrt(3 / (10 * n) * (2 + 5 * g**2 - 7 * g**4)) / (mpmath.pi * g**2 * b)
        expected = [
            root,
            mpmath.sqrt(12) * root / (2 * mpmath.pi * b),
            root / (2 * mpmath.pi * mpmath.sqrt(fc**2 + b**2 / 12)),
            mpmath.sqrt(12) * root / (2 * mpmath.pi * b) * mpmath.sqrt(mpmath.mpf(9) / 8),
            intensity,
            mpmath.erfc(mpmath.pi * b / fc / mpmath.sqrt(24 / (1 - 1 / n**2)) / root) if looks > 1 else mpmath.mpf(1),
            mpmath.erfc(mpmath.pi * b / fc / (3 * root)),
            200 * 1500 / mpmath.mpf("0.3") * root / (2 * mpmath.pi * fc),
        ]
    found = [
        bounds.phase_crlb(looks, coherence),
        bounds.group_delay_crlb(looks, coherence, band),
        bounds.coherent_delay_crlb(looks, coherence, 100e3, band),
        bounds.split_spectrum_crlb(looks, coherence, band, band / 3),
        bounds.intensity_delay_crlb(looks, coherence, band),
        bounds.gaussian_wrap_error_probability(looks, coherence, ratio),
        bounds.gaussian_split_spectrum_wrap_error_probability(3 * looks, coherence, ratio),
        bounds.depth_crlb(looks, coherence, 100e3, 200.0, 0.3),
    ]
    # Relative to 1e-12, but for what rounding does to a complementary error function far out.
    np.testing.assert_allclose(found, [float(x) for x in expected], rtol=1e-9, atol=1e-290)


@given(LOOKS, COHERENCE, RATIO)
def test_bounds_fall_with_looks_coherence_and_bandwidth(looks: float, coherence: float, ratio: float) -> None:
    here = bounds.group_delay_crlb(looks, coherence, ratio)
    assert bounds.group_delay_crlb(1.1 * looks, coherence, ratio) < here
    assert bounds.group_delay_crlb(looks, 0.5 * (1.0 + coherence), ratio) < here
    assert bounds.group_delay_crlb(looks, coherence, 1.01 * ratio) < here
    assert bounds.coherent_delay_crlb(looks, coherence, 1.0, ratio) <= here
    assert bounds.split_spectrum_crlb(looks, coherence, ratio, 0.3 * ratio) > here


def test_limits_and_validity() -> None:
    np.testing.assert_equal(bounds.phase_crlb(4, [0.0, 1.0, 1.1, -0.1, np.nan]), [np.inf, 0, np.nan, np.nan, np.nan])
    np.testing.assert_equal(bounds.phase_crlb([0.0, -1.0], 0.5), [np.nan, np.nan])
    with pytest.raises(ValueError, match=r"sub_bandwidth is 0\.6 of the bandwidth"):
        bounds.split_spectrum_crlb(4, 0.5, 1.0, 0.6)
    with pytest.raises(ValueError, match="bandwidth is -1 Hz"):
        bounds.group_delay_crlb(4, 0.5, -1.0)


def test_effective_looks_of_theory_and_of_its_integral() -> None:
    found = bounds.effective_looks([1.0, 4.0, 9.0, 16.0, 33.0, 81.0])
    np.testing.assert_allclose(found, [1.525, 4.554, 9.607, 16.65, 33.72, 81.80], rtol=3e-4)
    for bt in (1e-6, 0.0031, 0.0033, 0.3, 2.7):
        with mpmath.workdps(30):
            area = mpmath.quad(lambda u, bt=bt: 2 * (1 - u) * mpmath.sincpi(bt * u) ** 2, mpmath.linspace(0, 1, 5))
        assert float(bounds.effective_looks(bt) * area) == pytest.approx(1.0, rel=1e-11)
    for bt in (1e3, 1e6):
        # Its asymptotic series; the next term is of fourth order.
        inverse = 1.0 / bt - (np.log(2 * np.pi * bt) + np.euler_gamma + 1.0) / (np.pi * bt) ** 2
        assert float(bounds.effective_looks(bt)) * inverse == pytest.approx(1.0, rel=1e-9)
    np.testing.assert_equal(bounds.effective_looks([0.0, -1.0]), [1.0, np.nan])


@given(st.floats(-80.0, 120.0))
def test_snr_and_coherence_undo_each_other(decibel: float) -> None:
    rho = 10.0 ** (decibel / 10.0)
    # Coherence keeps 1e-16, hence 1e-4 of its distance from one at 120 dB.
    assert bounds.snr_from_coherence(bounds.coherence_from_snr(rho)) == pytest.approx(rho, rel=1e-15 * (1 + rho))
