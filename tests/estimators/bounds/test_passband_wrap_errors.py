import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from estimators import bounds
from estimators.bounds.passband_wrap_errors import _overlap

BOTH = [bounds.cross_correlation_wrap_error_probability, bounds.likelihood_wrap_error_probability]


def one_wrap_twin(looks: int, coherence: float, ratio: float, draws: int, *, projected: bool) -> tuple[float, float]:
    """
    Chance of a rival around the first wrap on either side, mean over drawn spectra, and its standard error.

    For each spectrum the arc that the direction of the rival sweeps, as a polyline, weighted by its Gaussian: in the
    space of all lines, or in the plane of its projections on 1 and frequency.
    """
    power = np.random.default_rng([looks, draws]).exponential(size=(draws, looks))
    offset = ratio * (np.arange(looks) - 0.5 * (looks - 1)) / looks
    q = coherence / (1.0 - coherence) * coherence / (1.0 + coherence)
    # Dense about the whole wrap.
    lag = 1.0 + 0.5 * np.sinh(np.linspace(-4.0, 4.0, 401)) / np.sinh(4.0)
    sine = np.sin(np.pi * np.outer(lag, 1.0 + offset))
    if projected:
        total = power.sum(axis=1)
        mean = power @ offset / total
        level = power @ sine.T
        slope = (power * offset) @ sine.T - mean[:, None] * level
        across = slope / np.sqrt(power @ offset**2 - total * mean**2)[:, None]
        along = level / np.sqrt(total)[:, None]
        square = along**2 + across**2
        angle = np.arctan2(across, along)
        arc = np.abs((np.diff(angle, axis=1) + np.pi) % (2 * np.pi) - np.pi)
    else:
        square = power @ (sine**2).T
        # From the sine: neighbouring directions differ too little for the cosine.
        chord2 = power @ ((sine[1:] - sine[:-1]) ** 2).T - (np.sqrt(square[:, 1:]) - np.sqrt(square[:, :-1])) ** 2
        chord = np.sqrt(np.maximum(chord2, 0.0) / np.sqrt(square[:, 1:] * square[:, :-1]))
        arc = 2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0))
    middle = 0.5 * (square[:, 1:] + square[:, :-1])
    chance = np.sum(arc * np.exp(-q * middle), axis=1) / np.pi
    return float(chance.mean()), float(chance.std() / np.sqrt(draws))


@pytest.mark.parametrize(
    ("looks", "coherence", "ratio"),
    [(3, 0.97, 0.6), (5, 0.9, 0.6), (9, 0.85, 0.6), (9, 0.93, 0.3), (33, 0.97, 0.1), (33, 0.57, 0.6), (90, 0.6, 0.3)],
)
def test_nearest_wrap_meets_a_plain_twin(looks: int, coherence: float, ratio: float) -> None:
    # Five standard errors, false alarm 6e-7, and one percent for the matched moments; overlap is below .3 %.
    for function, search, projected in ((BOTH[0], 1.5, True), (BOTH[1], 0.5, False)):
        mean, error = one_wrap_twin(looks, coherence, ratio, 16_000 if looks < 9 else 4000, projected=projected)
        assert mean < 0.05
        assert error < 0.05 * mean
        found = function(looks, coherence, ratio, search)
        assert abs(found - mean) < 5.0 * error + 0.01 * mean


@pytest.mark.parametrize(("ratio", "within"), [(0.1, 0.02), (0.3, 0.02), (0.6, 0.03), (1.0, 0.001)])
@pytest.mark.parametrize("nearest", [0.01, 0.1, 0.3, 0.45])
def test_overlap_of_wraps_meets_drawn_correlations(ratio: float, within: float, nearest: float) -> None:
    wraps = np.arange(1.0, 4.0)
    fall = 1.0 - np.sinc(ratio * wraps)
    # Signal and noise have the same correlation.
    behind = norm.isf(nearest) * np.sqrt(2.0 / fall[0]) * fall
    each = norm.sf(behind / np.sqrt(2.0 * fall))
    lags = np.concatenate([[0.0], wraps, -wraps])
    noise = np.random.default_rng(7).multivariate_normal(
        np.zeros(7), np.sinc(ratio * (lags[:, None] - lags)), 400_000, method="eigh"
    )
    wrong = np.any(noise[:, 1:] - np.tile(behind, 2) > noise[:, :1], axis=1)
    rate = wrong.mean()
    error = np.sqrt(rate * (1.0 - rate) / wrong.size)
    found = float(_overlap(each[:, None], wraps, ratio)[0] * 2.0 * each.sum())
    assert abs(found - rate) < 5.0 * error + within * rate


@pytest.mark.parametrize("function", BOTH)
@pytest.mark.parametrize("looks", [2, 5, 9, 33.4, 1000])
def test_narrow_bands_have_the_envelope_pair(function, looks: float) -> None:
    coherence = 1.0 - np.geomspace(1e-9, 0.5, 40)
    pair = bounds.wrap_error_probability(looks, coherence, 0.01)
    seen = (pair > 1e-9) & (pair < 0.3)
    assert seen.sum() > 2
    np.testing.assert_allclose(
        function(looks, coherence[seen], 0.01, 1.5 if function is BOTH[0] else 0.5), pair[seen], rtol=0.01
    )


@given(st.floats(1.0, 1e6), st.floats(0.0, 1.0), st.floats(1e-4, 1.9), st.sampled_from(BOTH))
@settings(max_examples=25, deadline=None)
def test_it_falls_with_looks_and_coherence(looks: float, coherence: float, ratio: float, function) -> None:
    more = min(1.1 * looks, 1e6)
    here, clearer, longer = function([looks, looks, more], [coherence, 0.5 * (1.0 + coherence), coherence], ratio)
    assert 0.0 <= here <= 1.0
    # Five digits are stated; two and three lines may alias at the second wrap of a wide band.
    assert clearer <= here * (1.0 + 1e-4)
    if looks >= 4.0:
        assert longer <= here * (1.0 + 1e-4)


@pytest.mark.parametrize("function", BOTH)
def test_extremes(function) -> None:
    looks = np.array([1.0, 1.5, 2.0, 9.3, 1e3, 1e6])[:, None, None]
    coherence = np.array([0.0, 1e-6, 0.5, 1.0 - 1e-6, 1.0 - 1e-12, 1.0])[:, None]
    rate = function(looks, coherence, [1e-4, 0.01, 0.3, 1.0, 1.9])
    assert np.all((rate >= 0.0) & (rate <= 1.0))
    np.testing.assert_equal(rate[1:, -1], 0.0)
    # Without coherence all delays within the search are alike.
    assert function(9.0, 0.0, 0.3, 3.0) == pytest.approx(1.0 - 1.0 / (6.0 if function is BOTH[0] else 8.0), rel=0.01)


@pytest.mark.parametrize("function", BOTH)
def test_validity(function) -> None:
    bad = function([0.5, 9.0, 9.0, 9.0, np.nan], [0.5, 1.1, 0.5, 0.5, 0.5], [0.3, 0.3, 0.0, 2.0, 0.3])
    assert np.all(np.isnan(bad))
    assert function(9.0, 0.1, 0.3, 0.4) == pytest.approx(0.0 if function is BOTH[0] else 0.6, abs=0.15)
    with pytest.raises(ValueError, match="search_wraps is 0"):
        function(9.0, 0.5, 0.3, 0.0)
