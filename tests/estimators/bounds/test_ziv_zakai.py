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
    [(9, 0.3, 0.3, 3.0), (9, 0.9, 0.6, 3.5), (33, 0.5, 0.3, 6.0), (20, 0.2, 1.2, 2.7), (5, 0.7, 0.3, 0.4)],
)
def test_bound_meets_a_plain_twin(looks: int, coherence: float, ratio: float, prior: float) -> None:
    found = bounds.ziv_zakai_delay_std(looks, coherence, 1.0, ratio, prior)
    assert found == pytest.approx(twin(looks, coherence, ratio, prior), rel=1e-3)


@given(st.floats(2.0, 1e5), st.floats(0.0, 1.0), st.floats(0.05, 1.5))
@settings(max_examples=12, deadline=None)
def test_bound_lies_between_the_cramer_rao_bound_and_the_prior(looks: float, coherence: float, ratio: float) -> None:
    prior = 3.0
    bound = bounds.ziv_zakai_delay_std(looks, coherence, 1.0, ratio, prior)
    assert bound <= prior / 12**0.5 * (1 + 1e-3)
    if bounds.coherent_delay_crlb(looks, coherence, 1.0, ratio) < 0.01 * prior:
        assert bound >= bounds.coherent_delay_crlb(looks, coherence, 1.0, ratio) * 0.98


def test_limits_and_validity() -> None:
    fc, b, prior = 100e3, 30e3, 6e-5
    assert bounds.ziv_zakai_delay_std(81, 0.0, fc, b, prior) == pytest.approx(prior / 12**0.5, rel=1e-3)
    assert bounds.ziv_zakai_delay_std(81, 1.0, fc, b, prior) == 0.0
    assert np.isnan(bounds.ziv_zakai_delay_std(81, 1.2, fc, b, prior))
    with pytest.raises(ValueError, match="bandwidth is 2 of the centre frequency"):
        bounds.ziv_zakai_delay_std(81, 0.5, fc, 2 * fc, prior)
