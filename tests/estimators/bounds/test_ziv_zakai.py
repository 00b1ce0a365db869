import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import bounds

ORACLES = Path(__file__).parents[2] / "oracles"


def test_oracle() -> None:
    with (ORACLES / "ziv_zakai.csv").open() as file:
        table = np.array([[float(v) for v in row] for row in list(csv.reader(file))[1:]])
    found = bounds.ziv_zakai_delay_std(table[:, 0], table[:, 1], 1.0, 0.3, 6.0)
    np.testing.assert_allclose(found, table[:, 2], rtol=0.02)


def twin(looks: int, coherence: float, ratio: float, prior: float) -> float:
    """The bound in wraps on an even grid of lags, lines and angles summed plainly."""
    frequency = 1 + ratio * (np.arange(looks) - (looks - 1) / 2) / looks
    q = coherence**2 / (1 - coherence**2)
    h = np.linspace(0.0, prior, 6001)
    level = q * np.sin(np.pi * h[:, None] * frequency) ** 2
    angles = (np.arange(100) + 0.5) / 100 * np.pi / 2
    p = sum(np.exp(-np.log1p(level / np.cos(a) ** 2).sum(axis=1)) for a in angles) / 200
    filled = np.maximum.accumulate(((1 - h / prior) * p)[::-1])[::-1]
    return float(np.sqrt(np.trapezoid(h * filled, h)))


@pytest.mark.parametrize(
    ("looks", "coherence", "ratio", "prior"),
    [
        (9, 0.3, 0.3, 3.0),
        (9, 0.9, 0.6, 3.5),
        (33, 0.5, 0.3, 6.0),
        (20, 0.2, 1.2, 2.7),
        (5, 0.7, 0.3, 0.4),
        (2, 0.9, 0.3, 3.5),
        (3, 0.5, 1.9, 3.5),
    ],
)
def test_bound_meets_a_plain_twin(looks: int, coherence: float, ratio: float, prior: float) -> None:
    found = bounds.ziv_zakai_delay_std(looks, coherence, 1.0, ratio, prior)
    assert found == pytest.approx(twin(looks, coherence, ratio, prior), rel=1e-3)


NODES = np.polynomial.legendre.leggauss(60)


def corner_twin(looks: int, coherence: float, ratio: float, prior: float) -> float:
    """
    As `twin`, but with lags crowded about zero and about every wrap of every line, which a strong signal needs.

    The probability is `1/pi int_0^inf prod_k (1 + x_k (1 + t^2))^-w dt / (1 + t^2)`, over even steps of asinh t.
    """
    # A million lines are a continuous band.
    if looks <= 300:
        position, weight = (np.arange(looks) - (looks - 1) / 2) / looks, np.ones(looks)
    else:
        position, weight = 0.5 * NODES[0], 0.5 * looks * NODES[1]
    frequency = 1 + ratio * position
    q = coherence / (1 - coherence) * coherence / (1 + coherence)
    wraps = (np.arange(1, int(2 * prior) + 2)[:, None] / np.append(frequency, 1.0)).ravel()
    wraps = np.concatenate([[0.0], wraps[wraps <= prior]]) if looks <= 6 else np.arange(int(prior) + 1.0)
    apart = np.concatenate([[0.0], np.geomspace(1e-12, 0.5, 500)])
    h = np.concatenate([np.linspace(0.0, prior, 2001), *(w + s * apart for w in wraps for s in (-1, 1))])
    h = np.unique(np.clip(h, 0.0, prior))
    turns = h[:, None] * frequency
    x = q * np.sin(np.pi * (turns - np.rint(turns))) ** 2
    level = np.log1p(x) @ weight
    share = x / (1 + x)
    near = level < 80.0
    width = 1.0 / np.sqrt(np.maximum(1.0, share[near] @ weight))
    total = np.full(width.size, 0.5)
    for w in np.arange(0.25, 20.0, 0.25):
        t2 = (width * np.sinh(w)) ** 2
        total += np.cosh(w) / (1 + t2) * np.exp(-np.log1p(share[near] * t2[:, None]) @ weight)
    p = np.zeros(h.size)
    p[near] = np.exp(-level[near]) * total * width * 0.25 / np.pi
    filled = np.maximum.accumulate(((1 - h / prior) * p)[::-1])[::-1]
    left, right = h[:-1], h[1:]
    return float(np.sqrt(np.sum((filled[:-1] * (2 * left + right) + filled[1:] * (left + 2 * right)) * np.diff(h)) / 6))


@pytest.mark.parametrize("ratio", [1e-4, 1e-3, 1.9])
@pytest.mark.parametrize("looks", [1, 2, 4, 9, 40, 1_000_000])
def test_bound_at_the_corners(looks: int, ratio: float) -> None:
    coherence = np.array([1e-6, 0.3, 0.9, 1.0 - 1e-5, 1.0 - 1e-7, 1.0 - 1e-12])
    found = bounds.ziv_zakai_delay_std(looks, coherence, 1.0, ratio, 3.5)
    np.testing.assert_allclose(found, [corner_twin(looks, g, ratio, 3.5) for g in coherence], rtol=1e-3)


@given(
    st.floats(1.0, 1e6),
    st.floats(1e-6, 1.0 - 1e-12),
    st.floats(1e-4, 1.9),
    st.floats(0.05, 8.0),
)
@settings(max_examples=40, deadline=None)
def test_bound_lies_between_the_cramer_rao_bound_and_the_prior(
    looks: float, coherence: float, ratio: float, prior: float
) -> None:
    bound = bounds.ziv_zakai_delay_std(looks, coherence, 1.0, ratio, prior)
    assert bound <= prior / 12**0.5 * (1 + 1e-3)
    crlb = bounds.coherent_delay_crlb(looks, coherence, 1.0, ratio)
    # With P(h) = Q(h / 2 sigma), the factor 1 - h / T takes 8/3 sqrt(2 / pi) sigma / T off the mean square error.
    if crlb < 0.1 * prior:
        assert bound >= crlb * (np.sqrt(1 - 2.1277 * crlb / prior) - 1e-3)


def test_many_elements_at_once_are_the_single_ones() -> None:
    n = np.array([1.0, 1.7, 5.9, 6.1, 33.0, 250.0, 1e5])
    g = np.array([0.2, 0.9999, 0.7, 0.95])[:, None]
    prior = np.array([2.0, 6.0])[:, None, None]
    together = bounds.ziv_zakai_delay_std(n, g, 1.0, 0.3, prior)
    assert together.shape == (2, 4, 7)
    alone = [[[float(bounds.ziv_zakai_delay_std(a, b, 1.0, 0.3, c)) for a in n] for b in g[:, 0]] for c in (2.0, 6.0)]
    np.testing.assert_allclose(together, alone, rtol=1e-3)


@given(st.floats(1.0, 1e6), st.floats(1e-4, 1.9), st.floats(0.05, 8.0))
@settings(max_examples=20, deadline=None)
def test_bound_tends_to_the_prior(looks: float, ratio: float, prior: float) -> None:
    bound = bounds.ziv_zakai_delay_std(looks, [0.0, 1e-3 / np.sqrt(looks)], 1.0, ratio, prior)
    np.testing.assert_allclose(bound[0], prior / 12**0.5, rtol=1e-3)
    np.testing.assert_allclose(bound[1], prior / 12**0.5, rtol=3e-3)


def test_limits_and_validity() -> None:
    fc, b, prior = 100e3, 30e3, 6e-5
    assert bounds.ziv_zakai_delay_std(81, 0.0, fc, b, prior) == pytest.approx(prior / 12**0.5, rel=1e-3)
    assert bounds.ziv_zakai_delay_std(81, 1.0, fc, b, prior) == 0.0
    # One line is blind to whole wraps: P is one half there, whatever the coherence.
    steps = sum(0.5 * (1 - m / 3.5) * (m**2 - (m - 1) ** 2) / 2 for m in (1, 2, 3))
    assert bounds.ziv_zakai_delay_std(1, 1.0, 1.0, 0.3, 3.5) == pytest.approx(steps**0.5, rel=1e-3)
    assert np.isnan(bounds.ziv_zakai_delay_std(81, 1.2, fc, b, prior))
    with pytest.raises(ValueError, match="bandwidth is 2 of the centre frequency"):
        bounds.ziv_zakai_delay_std(81, 0.5, fc, 2 * fc, prior)
