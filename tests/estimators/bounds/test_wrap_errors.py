import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ive
from scipy.stats import ncx2

from estimators import bounds

ORACLES = Path(__file__).parents[2] / "oracles"


def column(name: str) -> np.ndarray:
    with (ORACLES / "wrap_rates.csv").open() as file:
        return np.array([float(row[name]) for row in csv.DictReader(file)])


POINT = column("looks"), column("coherence"), column("relative_bandwidth")


def test_oracle() -> None:
    half_digit = 5.1e-5
    np.testing.assert_allclose(
        2 * bounds.coherent_pair_probability(*POINT), column("twice_coherent_pair"), rtol=0, atol=half_digit
    )
    np.testing.assert_allclose(
        bounds.gaussian_wrap_error_probability(*POINT), column("twice_gaussian"), rtol=0, atol=half_digit
    )
    found, expected = bounds.wrap_error_probability(*POINT), column("twice_envelope_pair")
    np.testing.assert_allclose(found[1:], expected[1:], rtol=0.01)
    # The file's first value, .0540, is an average of its own: the exact one, here to 1e-3, is .05334.
    assert found[0] == pytest.approx(0.05334, rel=1e-3)


def envelope_pair_twin(looks: int, coherence: float, ratio: float, draws: int, seed: int) -> tuple[float, float]:
    """Plain Monte Carlo of theory section 3: mean of 2 P_env over drawn spectra, and its standard error."""
    theta = 2 * np.pi * ratio * np.arange(looks) / looks
    power = np.random.default_rng(seed).exponential(size=(draws, looks))
    total = power.sum(axis=1)
    r = np.abs(power @ np.exp(1j * theta)) / total
    kappa = coherence**2 * total / (1 - coherence**2)
    spread = np.sqrt(np.maximum(1 - r**2, 0.0))
    a, b = np.sqrt(kappa / 2 * (1 - spread)), np.sqrt(kappa / 2 * (1 + spread))
    p = 2 * (ncx2.sf(b**2, 2, a**2) - 0.5 * np.exp(-0.5 * (a - b) ** 2) * ive(0, a * b))
    return float(p.mean()), float(p.std() / np.sqrt(draws))


@pytest.mark.parametrize(
    ("looks", "coherence", "ratio"),
    [
        (2, 0.9, 0.5),
        (3, 0.9, 0.3),
        (5, 0.6, 1.2),
        (9, 0.9, 0.3),
        (9, 0.9, 1.9),
        (24, 0.5, 0.4),
        (81, 0.5, 0.3),
    ],
)
def test_average_meets_a_plain_twin(looks: int, coherence: float, ratio: float) -> None:
    mean, error = envelope_pair_twin(looks, coherence, ratio, 100_000, seed=looks)
    # Five standard errors, false alarm 6e-7, beside the stated accuracy.
    found = bounds.wrap_error_probability(looks, coherence, ratio)
    assert abs(found - mean) < 5.0 * error + 1e-3 * mean


@pytest.mark.parametrize(
    ("looks", "q", "expected"),
    [
        (3, 30.0, 4.79438474e-2),
        (3, 1e5, 6.39515154e-9),
        (4, 1e4, 1.17330993e-9),
        (7, 300.0, 1.51317034e-8),
        (9, 200.0, 1.41739200e-9),
        (13, 50.0, 4.32857426e-8),
        (20, 20.0, 1.03654430e-7),
        (24, 20.0, 4.77288474e-9),
    ],
)
def test_tails_meet_exact_quadrature(looks: int, q: float, expected: float) -> None:
    # Three-dimensional quadrature without approximation, B / fc = 0.3: over the direction of the wrong
    # envelope, the slope of a weighted least-squares line, and the root of a sum of exponentials.
    found = bounds.wrap_error_probability(looks, np.sqrt(q / (1 + q)), 0.3)
    assert found == pytest.approx(expected, rel=1e-3)


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0), st.floats(1e-4, 0.9))
@settings(max_examples=40, deadline=None)
def test_wrap_error_falls_with_looks_coherence_and_bandwidth(looks: float, coherence: float, ratio: float) -> None:
    here = bounds.wrap_error_probability(looks, coherence, ratio)
    assert 0.0 <= here <= 1.0
    assert bounds.wrap_error_probability(min(1.1 * looks, 1e6), coherence, ratio) <= here
    assert bounds.wrap_error_probability(looks, 0.5 * (1.0 + coherence), ratio) <= here
    assert bounds.wrap_error_probability(looks, coherence, 1.1 * ratio) <= here
    if here > 1e-10:
        assert bounds.coherent_pair_probability(looks, coherence, ratio) <= 0.5 * here * (1.0 + 2e-3)


def test_limits_and_validity() -> None:
    np.testing.assert_equal(bounds.wrap_error_probability([1.0, 9.0, 9.0], [0.5, 0.0, 1.0], 0.3), [1.0, 1.0, 0.0])
    bad = bounds.wrap_error_probability([0.5, 9.0, 9.0, 9.0], [0.5, 1.1, 0.5, 0.5], [0.3, 0.3, 0.0, 2.0])
    assert np.all(np.isnan(bad))
    with pytest.raises(ValueError, match="wraps is 0"):
        bounds.several_wraps_error_probability(9, 0.5, 0.3, 0)


def test_sum_of_two_wraps_of_theory() -> None:
    assert bounds.wrap_error_probability(4, 0.9, 0.6) == pytest.approx(0.062, abs=5e-4)
    assert bounds.several_wraps_error_probability(4, 0.9, 0.6, 2) == pytest.approx(0.094, abs=5e-4)


def test_coherent_pair_equals_the_inversion_integral() -> None:
    n, g, ratio = 7, 0.6, 0.8
    c = 1 - np.exp(2j * np.pi * ratio * (np.arange(n) - 3) / n)
    root = np.sqrt((g * c.real) ** 2 + (1 - g**2) * np.abs(c) ** 2)
    roots = 0.5 * np.concatenate([g * c.real + root, g * c.real - root])
    u = np.linspace(-20.0, 20.0, 8001)
    lt = np.outer(np.exp(u), roots)
    integrand = np.sin(np.arctan(lt).sum(axis=1)) * np.exp(-0.5 * np.log1p(lt**2).sum(axis=1))
    expected = 0.5 - np.trapezoid(integrand, u) / np.pi
    assert bounds.coherent_pair_probability(n, g, ratio) == pytest.approx(expected, rel=1e-6)


def test_saddle_point_is_within_what_theory_says() -> None:
    for n, within in ((9, 0.01), (81, 0.001)):
        exact = bounds.coherent_pair_probability(n, [0.3, 0.6, 0.9], 0.3)
        np.testing.assert_allclose(bounds.lugannani_rice_pair_probability(n, [0.3, 0.6, 0.9], 0.3), exact, rtol=within)


def test_split_spectrum_meets_a_plain_twin() -> None:
    rng = np.random.default_rng(11)
    for n, g, ratio in ((9, 0.9, 0.3), (81, 0.5, 0.3), (4, 0.9, 1.2)):
        power, noise = rng.gamma(n / 3, size=(2, 200_000)), rng.standard_normal((2, 200_000, 2)) @ [1, 1j]
        signal = g * np.sqrt(power) + np.sqrt((1 - g**2) / 2) * noise
        p = np.mean(np.abs(np.angle(signal[0] * signal[1].conj())) > np.pi * ratio * 2 / 3)
        # Five standard errors: false alarm 6e-7.
        found = bounds.split_spectrum_wrap_error_probability(n, g, ratio)
        assert abs(found - p) < 5.0 * np.sqrt(p * (1 - p) / 200_000)
