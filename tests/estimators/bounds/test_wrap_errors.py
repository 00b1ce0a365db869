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
    # The file's first value, .0540, is a Monte Carlo average that lies 1.3 % high: the mean over 6e6 spectra is
    # .05331 +- .00002, complex Gaussian lines compared at lags 0 and 1 / fc give .05327 +- .00009, and the
    # quadrature of the next test .05331. One spectrum scatters by .054, so some 6,000 of them miss by that much.
    assert expected[0] == 0.0540
    assert found[0] == pytest.approx(0.05331, rel=1e-3)


def turned(split: np.ndarray, q: float, looks: int, step: float) -> np.ndarray:
    """
    Twice P_env at `split = 1 - R^2`, averaged over the total power of the lines, `G0 ~ Gamma(N)`.

    Simon's integral of Marcum's function, `1/2pi int sqrt(1 - R^2) exp(-kappa x) / (2 x) dpsi` with
    `x = (1 - R cos psi) / 2`, in the eccentric anomaly eta of psi: `1/pi int_0^pi (1 + q x)^-N d eta`,
    `x = (1 - R^2) / (2 (1 + R cos eta))`. By even steps of `log tan(eta / 2)`.
    """
    r = np.sqrt(1.0 - split)
    total = np.zeros(np.shape(split))
    for z in np.arange(-42.0, 42.0, step):
        below = split / (1.0 + r) + 2.0 * r / (1.0 + np.exp(2.0 * z))
        total += step / np.cosh(z) / np.pi * np.exp(-looks * np.log1p(0.5 * q * split / below))
    return total


def logistic(step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A share in (0, 1), what it leaves, and weights."""
    s = np.arange(-46.0, 46.0, step)
    share, rest = 1.0 / (1.0 + np.exp(-s)), 1.0 / (1.0 + np.exp(s))
    return share, rest, step * share * rest


def two_lines(q: float, ratio: float) -> float:
    share, rest, weight = logistic(0.2)
    return float(weight @ turned(4.0 * share * rest * np.sin(0.5 * np.pi * ratio) ** 2, q, 2, 0.2))


def three_lines(q: float, ratio: float) -> float:
    u, rest, outer = logistic(0.5)
    v, other, inner = logistic(0.5)
    first, second, third = u[:, None], rest[:, None] * v, rest[:, None] * other
    near, far = (4.0 * np.sin(k * np.pi * ratio / 3.0) ** 2 for k in (1, 2))
    split = near * second * (first + third) + far * first * third
    return float((2.0 * outer * rest) @ turned(np.minimum(split, 1.0), q, 3, 0.5) @ inner)


@pytest.mark.parametrize("ratio", [1e-4, 0.01, 0.3, 1.0, 1.9])
@pytest.mark.parametrize("coherence", [1e-6, 0.3, 0.9, 0.999, 1.0 - 1e-6, 1.0 - 1e-12])
def test_two_and_three_looks_meet_quadrature_over_their_powers(coherence: float, ratio: float) -> None:
    q = coherence / (1.0 - coherence) * coherence / (1.0 + coherence)
    found = bounds.wrap_error_probability([2, 3], coherence, ratio)
    np.testing.assert_allclose(found, [two_lines(q, ratio), three_lines(q, ratio)], rtol=1e-3)


def envelope_pair_twin(looks: int, coherence: float, ratio: float, draws: int, seed: int) -> tuple[float, float]:
    """Plain Monte Carlo of theory section 3: mean of 2 P_env over drawn spectra, and its standard error."""
    theta = 2 * np.pi * ratio * (np.arange(looks) - 0.5 * (looks - 1)) / looks
    power = np.random.default_rng(seed).exponential(size=(draws, looks))
    total = power.sum(axis=1)
    mean_phase = np.angle(power @ np.exp(1j * theta))
    rest = 2.0 * np.sum(power * np.sin(0.5 * (theta - mean_phase[:, None])) ** 2, axis=1) / total
    kappa = coherence / (1.0 - coherence) * coherence / (1.0 + coherence) * total
    spread = np.sqrt(rest * (2.0 - rest))
    # 1 - sqrt(1 - R^2) loses digits at small R only.
    a, b = np.sqrt(kappa / 2 * (1 - spread)), np.sqrt(kappa / 2 * (1 + spread))
    p = 2 * (ncx2.sf(b**2, 2, a**2) - 0.5 * np.exp(-0.5 * (a - b) ** 2) * ive(0, a * b))
    return float(p.mean()), float(p.std() / np.sqrt(draws))


@pytest.mark.parametrize(
    ("looks", "coherence", "ratio", "draws"),
    [
        (5, 0.6, 1.2, 100_000),
        (9, 0.9, 0.3, 400_000),
        (9, 0.9, 1.9, 100_000),
        (24, 0.5, 0.4, 100_000),
        (81, 0.5, 0.3, 40_000),
        (81, 0.99, 0.004, 40_000),
        (1000, 0.1, 0.3, 2_000),
        (100_000, 1e-3, 1.9, 20),
        (100_000, 0.9, 1e-3, 20),
    ],
)
def test_average_meets_a_plain_twin(looks: int, coherence: float, ratio: float, draws: int) -> None:
    mean, error = envelope_pair_twin(looks, coherence, ratio, draws, seed=looks)
    # Five standard errors, seven for the Student distributed means of 20: false alarm 1e-6, beside the stated accuracy.
    found = bounds.wrap_error_probability(looks, coherence, ratio)
    assert abs(found - mean) < (5.0 if draws > 100 else 7.0) * error + 1e-3 * mean


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


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0), st.floats(1e-4, 1.9))
@settings(max_examples=40, deadline=None)
def test_wrap_error_falls_with_looks_and_coherence(looks: float, coherence: float, ratio: float) -> None:
    here = bounds.wrap_error_probability(looks, coherence, ratio)
    assert 0.0 <= here <= 1.0
    assert bounds.wrap_error_probability(looks, 0.5 * (1.0 + coherence), ratio) <= here * (1.0 + 1e-12)
    # A band wider than its centre frequency makes two and three lines alias, so that more looks can be worse.
    if ratio <= 1.0 or looks >= 4.0 or looks <= 1.8:
        assert bounds.wrap_error_probability(min(1.1 * looks, 1e6), coherence, ratio) <= here * (1.0 + 1e-12)
    if here > 1e-10:
        assert bounds.coherent_pair_probability(looks, coherence, ratio) <= 0.5 * here * (1.0 + 2e-3)


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0), st.floats(1e-4, 0.9))
@settings(max_examples=40, deadline=None)
def test_wrap_error_falls_with_bandwidth(looks: float, coherence: float, ratio: float) -> None:
    pair = bounds.coherent_pair_probability(looks, coherence, [ratio, 1.1 * ratio])
    assert pair[1] <= pair[0] * (1.0 + 1e-9)
    here, wider = bounds.wrap_error_probability(looks, coherence, [ratio, 1.1 * ratio])
    assert wider <= here * (1.0 + 1e-3)


@pytest.mark.parametrize("ratio", [1e-4, 0.3, 0.9])
@pytest.mark.parametrize("coherence", [1e-3, 0.5, 0.99, 1.0 - 1e-12])
def test_wrap_error_is_smooth_between_whole_looks(coherence: float, ratio: float) -> None:
    n = np.concatenate([np.linspace(1.0, 40.0, 1561), np.geomspace(40.1, 1e6, 2000)])
    with np.errstate(divide="ignore"):
        exponent = -np.log(bounds.wrap_error_probability(n, coherence, ratio))
    seen = (exponent < 60.0) & (n < 40.0)
    steps = np.diff(exponent[seen])
    assert np.all(steps > 0.0)
    # Neighbouring slopes over a fortieth of a look differ by less than a tenth, kinks included.
    assert np.all(np.abs(np.diff(steps)) < 0.1 * steps[1:] + 1e-9)
    assert np.all(np.diff(exponent[exponent < 150.0]) > 0.0)


def test_limits_and_validity() -> None:
    np.testing.assert_equal(bounds.wrap_error_probability([1.0, 9.0, 9.0], [0.5, 0.0, 1.0], 0.3), [1.0, 1.0, 0.0])
    bad = bounds.wrap_error_probability([0.5, 9.0, 9.0, 9.0], [0.5, 1.1, 0.5, 0.5], [0.3, 0.3, 0.0, 2.0])
    assert np.all(np.isnan(bad))
    with pytest.raises(ValueError, match="wraps is 0"):
        bounds.several_wraps_error_probability(9, 0.5, 0.3, 0)


def test_several_wraps() -> None:
    # Theory section 3: one wrap .062 and two .094 at few looks; .60 for the nearest at nine.
    assert bounds.wrap_error_probability(4, 0.9, 0.6) == pytest.approx(0.062, abs=5e-4)
    assert bounds.several_wraps_error_probability(4, 0.9, 0.6, 2) == pytest.approx(0.094, abs=5e-4)
    assert bounds.wrap_error_probability(9, 0.5, 0.3) == pytest.approx(0.60, abs=5e-3)
    # Four lines 1/4 of .6 apart: the third wrap lies beyond 2 / .6 = 3.3 wraps of half a window, the fourth does.
    three, four = (bounds.several_wraps_error_probability(4, 0.9, 0.6, k) for k in (3, 4))
    far = envelope_pair_twin(4, 0.9, 1.8, 100_000, seed=4)
    two = bounds.several_wraps_error_probability(4, 0.9, 0.6, 2)
    assert abs(three - two - far[0]) < 5.0 * far[1] + 1e-3 * far[0]
    assert four == three
    assert bounds.several_wraps_error_probability(9, 0.1, 0.3, 3) == 1.0


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


@pytest.mark.parametrize(
    ("looks", "coherence", "ratio"),
    [
        (4, 1.0 - 1e-12, 0.3),
        (20, 1.0 - 1e-12, 1.9),
        (33, 1.0 - 1e-12, 1e-4),
        (33, 1.0 - 1e-6, 0.3),
        (150, 0.999, 0.3),
        (400, 0.9, 1.9),
        (1000, 0.9, 0.3),
        (1_000_000, 1e-3, 1.9),
        (1_000_000, 0.9, 1e-4),
    ],
)
def test_coherent_pair_counts_every_line_in_its_tail(looks: int, coherence: float, ratio: float) -> None:
    q = coherence / (1.0 - coherence) * coherence / (1.0 + coherence)
    # One half of the lines mirrors the other.
    offset = np.arange(0.5 * (1 - looks % 2), 0.5 * looks)
    x = q * np.sin(np.pi * ratio * offset / looks) ** 2
    pairs = np.where(offset == 0.0, 1.0, 2.0)
    width = 1.0 / np.sqrt(max(1.0, float(pairs @ (x / (1.0 + x)))))
    # Trapezoids over asinh of t of prod (1 + x (1 + t^2))^-1 / (1 + t^2).
    total = 0.5
    for w in np.arange(0.2, 36.0, 0.2):
        t2 = (width * np.sinh(w)) ** 2
        term = np.cosh(w) / (1.0 + t2) * np.exp(-float(pairs @ np.log1p(x / (1.0 + x) * t2)))
        total += term
        if term < 1e-16 * total:
            break
    expected = np.exp(-float(pairs @ np.log1p(x))) * total * width * 0.2 / np.pi
    assert expected > 1e-290
    assert bounds.coherent_pair_probability(looks, coherence, ratio) == pytest.approx(expected, rel=1e-6)


def test_saddle_point_is_within_what_theory_says() -> None:
    np.testing.assert_allclose(bounds.coherent_pair_probability(1.0, [1e-6, 0.5, 1.0 - 1e-12], 0.3), 0.5, rtol=1e-7)
    for n, within in ((9, 0.01), (81, 0.001)):
        exact = bounds.coherent_pair_probability(n, [0.3, 0.6, 0.9], 0.3)
        np.testing.assert_allclose(bounds.lugannani_rice_pair_probability(n, [0.3, 0.6, 0.9], 0.3), exact, rtol=within)
