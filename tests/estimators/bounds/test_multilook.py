import csv
from pathlib import Path

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import betainc

from estimators import bounds

ORACLES = Path(__file__).parents[2] / "oracles"


def rows() -> list[dict[str, float]]:
    with (ORACLES / "multilook.csv").open() as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def test_oracle_to_its_five_digits() -> None:
    table = rows()
    n, g = [r["looks"] for r in table], [r["coherence"] for r in table]
    for name, found in (
        ("phase_std_rad", bounds.multilook_phase_std(n, g)),
        ("mean_sample_coherence", bounds.sample_coherence_mean(n, g)),
        ("std_sample_coherence", bounds.sample_coherence_std(n, g)),
    ):
        expected = np.array([r[name] for r in table])
        digits = 1e-6 if name.startswith("mean") else 0.0
        np.testing.assert_allclose(found, expected, rtol=0, atol=5.1e-6 + digits)


@pytest.mark.parametrize("looks", [1.0, 1.3, 4.0, 81.0])
@pytest.mark.parametrize("coherence", [0.0, 1e-6, 0.5, 0.9999])
def test_density_equals_hypergeometric_form(looks: float, coherence: float) -> None:
    phases = [0.0, 1e-3, 0.1, 1.0, 3.1]
    with mpmath.workdps(40):
        n, g = mpmath.mpf(looks), mpmath.mpf(coherence)
        front = (1 - g**2) ** n / (2 * mpmath.pi * (2 * n + 1))
        expected = [float(front * mpmath.hyp2f1(2, 2 * n, n + 1.5, (1 + g * mpmath.cos(p)) / 2)) for p in phases]
    np.testing.assert_allclose(bounds.multilook_phase_pdf(phases, looks, coherence), expected, rtol=1e-8)


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0 - 1e-12))
@settings(max_examples=40, deadline=None)
def test_half_plane_is_an_incomplete_beta_function(looks: float, coherence: float) -> None:
    behind = 2.0 * bounds.multilook_phase_cdf(-0.5 * np.pi, looks, coherence)
    assert behind == pytest.approx(betainc(looks, looks, 0.5 * (1.0 - coherence)), rel=1e-6, abs=1e-280)


NODES = np.polynomial.legendre.leggauss(200)


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0 - 1e-12), st.floats(1e-9, 0.5))
@settings(max_examples=40, deadline=None)
def test_density_integrates_to_the_distribution(looks: float, coherence: float, probability: float) -> None:
    low = float(bounds.multilook_phase_quantile(probability, looks, coherence))
    assert bounds.multilook_phase_cdf(low, looks, coherence) == pytest.approx(probability, rel=1e-6)
    x, w = NODES
    scale = min(1.0, float(bounds.phase_crlb(looks, coherence)))
    for end, area in ((-low, 0.5 - probability), (np.pi, 0.5)):
        span = np.arcsinh(end / scale)
        v = 0.5 * span * (x + 1.0)
        density = bounds.multilook_phase_pdf(scale * np.sinh(v), looks, coherence)
        assert 0.5 * span * np.sum(w * scale * np.cosh(v) * density) == pytest.approx(area, abs=2e-8)


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0 - 1e-12))
@settings(max_examples=40, deadline=None)
def test_phase_std_falls_with_looks_and_coherence(looks: float, coherence: float) -> None:
    n, g = np.array([looks, 1.1 * looks, looks]), np.array([coherence, coherence, 0.5 * (1.0 + coherence)])
    here, more, better = bounds.multilook_phase_std(n, g)
    assert more <= here * (1.0 + 1e-9)
    assert better <= here * (1.0 + 1e-9)
    assert here <= np.pi / 3**0.5 * (1.0 + 1e-9)


def test_limits() -> None:
    np.testing.assert_allclose(bounds.multilook_phase_std([1.0, 7.5, 1e6], 0.0), np.pi / 3**0.5, rtol=1e-9)
    np.testing.assert_allclose(
        bounds.multilook_phase_std(1e6, [0.5, 1 - 1e-12]), bounds.phase_crlb(1e6, [0.5, 1 - 1e-12]), rtol=2e-6
    )
    np.testing.assert_equal(bounds.multilook_phase_std([4.0, 0.5, 4.0], [1.0, 0.5, 1.5]), [0.0, np.nan, np.nan])


def test_sampler_follows_the_distribution() -> None:
    draws = bounds.sample_multilook_phase(2.5, 0.6, rng=np.random.default_rng(3), size=200_000)
    for phase in (-2.0, -0.5, 0.1, 1.0):
        p = float(bounds.multilook_phase_cdf(phase, 2.5, 0.6))
        # Five standard errors: false alarm 6e-7 for each phase.
        assert abs(np.mean(draws < phase) - p) < 5.0 * np.sqrt(p * (1 - p) / draws.size)
    with pytest.raises(ValueError, match="coherence is"):
        bounds.sample_multilook_phase(4, 1.2, rng=np.random.default_rng(1))
