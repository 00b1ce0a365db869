"""What must hold for every estimator."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import METHODS as SHIPPED

from estimators import (
    CrossCorrelation,
    Estimator,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
)

METHODS = {
    **SHIPPED,
    "multi-chromatic-group": lambda window: MultiChromatic(window, bands=6, refine=False),
    "phase-slope-strongest": lambda window: FullBandPhaseSlope(window, peak="strongest", lags_per_resolution=8),
    "two-window-wide": lambda window: TwoWindow(MaximumLikelihood(window), FixedWindow(1, 5)),
}
WRAP = 1 / 100e3
SHARES = ("coherence", "debiased_coherence", "wrap_error_probability", "quality")

method = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)

PATCH = {
    "samples": st.integers(24, 60),
    "coherence": st.floats(0.0, 0.999),
    # A few, as the predicted wrap errors of each are tabulated once.
    "relative_bandwidth": st.sampled_from([0.01, 0.1, 0.3, 0.6, 1.2, 1.9]),
    "oversampling": st.sampled_from([1.0, 1.1, 4 / 3, 2.0, 3.0]),
    "seed": st.integers(0, 2**32 - 1),
    "circular": st.booleans(),
}
WINDOW = st.builds(FixedWindow, st.integers(1, 3), st.integers(1, 24))


@method
@settings(max_examples=25, deadline=None)
@given(options=st.fixed_dictionaries(PATCH), window=WINDOW)
def test_swapping_the_receivers_negates_the_delay(make_patch, method, options, window):
    pair = make_patch(delay=0.3e-5, **options)
    there = method(window).estimate(pair)
    back = method(window).estimate(replace(pair, primary=pair.secondary, secondary=pair.primary))
    np.testing.assert_allclose(there.delay, -back.delay, atol=1e-7 * WRAP)
    np.testing.assert_allclose(there.coherence, back.coherence, atol=1e-9)
    np.testing.assert_array_equal(there.valid, back.valid)


@method
@settings(max_examples=25, deadline=None)
@given(
    options=st.fixed_dictionaries(PATCH), window=WINDOW, exponent=st.floats(-150.0, 150.0), phase=st.floats(-3.14, 3.14)
)
def test_a_common_gain_or_phase_changes_nothing(make_patch, method, options, window, exponent, phase):
    pair = make_patch(delay=0.3e-5, **options)
    factor = 10.0**exponent * np.exp(1j * phase)
    plain = method(window).estimate(pair)
    scaled = method(window).estimate(replace(pair, primary=factor * pair.primary, secondary=factor * pair.secondary))
    for name in ("delay", "delay_std"):
        np.testing.assert_allclose(getattr(scaled, name), getattr(plain, name), atol=1e-7 * WRAP, rtol=1e-7)
    np.testing.assert_allclose(np.exp(1j * scaled.phase), np.exp(1j * plain.phase), atol=1e-7)
    np.testing.assert_allclose(scaled.coherence, plain.coherence, atol=1e-9)
    np.testing.assert_array_equal(scaled.valid, plain.valid)


@method
@settings(max_examples=25, deadline=None)
@given(options=st.fixed_dictionaries(PATCH), window=WINDOW)
def test_what_is_reported_lies_within_its_limits(make_patch, method, options, window):
    pair = make_patch(**options)
    estimate = method(window).estimate(pair)
    for name in ("delay", "phase", *SHARES, "delay_std", "valid"):
        assert getattr(estimate, name).shape == pair.shape
    for name in SHARES:
        value = getattr(estimate, name)[estimate.valid]
        assert np.all((value >= 0) & (value <= 1))
    assert np.all(np.isfinite(estimate.delay[estimate.valid]))
    assert np.all(np.abs(estimate.phase) <= np.pi)
    assert np.all((estimate.delay_std >= 0) & (estimate.delay_std < 1.0))


@pytest.mark.parametrize(
    ("method", "tolerance"),
    [
        # The phase at zero lag is that at the centroid of the speckle's spectrum, off by B / sqrt(12 N): 0.005 wraps of
        # standard deviation at these delays.
        (Interferogram, 0.03),
        (SplitSpectrum, 0.03),
        (MultiChromatic, 0.03),
        (CrossCorrelation, 1e-4),
        (METHODS["cross-correlation-group"], 1e-4),
        (MaximumLikelihood, 1e-4),
        (FullBandPhaseSlope, 1e-4),
        (lambda window: TwoWindow(CrossCorrelation(window), window), 1e-4),
    ],
)
@settings(max_examples=30, deadline=None)
@given(
    delay=st.floats(-0.45, 0.45), more=st.floats(-0.45, 0.45), seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 3)
)
def test_a_delay_moves_the_estimate_by_it(make_patch, method, tolerance, delay, more, seed, rows):
    # Full coherence, so that only the method's own error is left.
    pair, moved = (
        make_patch(rows, 63, coherence=1.0, delay=shift * WRAP, seed=seed, oversampling=1.0) for shift in (delay, more)
    )
    estimator = method(FixedWindow(1, 63))
    shift = estimator.estimate(moved).delay - estimator.estimate(pair).delay
    np.testing.assert_allclose(shift, (more - delay) * WRAP, atol=tolerance * WRAP)


@method
def test_silence_is_not_valid(make_patch, method):
    pair = make_patch()
    silent = replace(pair, primary=0 * pair.primary)
    estimate = method(FixedWindow(1, 9)).estimate(silent)
    assert not estimate.valid.any()
    assert np.all(np.isfinite(estimate.delay))


@method
def test_windows_that_leave_a_measured_record_are_not_valid(make_patch, method):
    estimate = method(FixedWindow(3, 9)).estimate(make_patch(5, 40, circular=False))
    assert not estimate.valid[:, :4].any()
    assert not estimate.valid[:, -4:].any()
    assert not estimate.valid[[0, -1]].any()
    assert estimate.valid[1:-1, 4:-4].any()


@pytest.mark.parametrize("rows", [1, 3, 4])
@method
def test_the_result_does_not_depend_on_the_rows_in_a_block(make_patch, method, rows, monkeypatch):
    pair = make_patch(11, 40, coherence=0.7)
    whole = method(FixedWindow(rows, 9)).estimate(pair)
    monkeypatch.setattr("estimators.search.BLOCK_BYTES", 1)
    monkeypatch.setattr("estimators.search.NEAR_BYTES", 1)
    by_row = method(FixedWindow(rows, 9)).estimate(pair)
    for name in ("delay", "coherence", "quality", "valid"):
        np.testing.assert_array_equal(getattr(by_row, name), getattr(whole, name))


@method
def test_the_result_does_not_depend_on_the_times_searched_together(make_patch, method, monkeypatch):
    pair = make_patch(3, 50, coherence=0.7)
    whole = method(FixedWindow(1, 9)).estimate(pair)
    monkeypatch.setattr("estimators.search.CACHE_BYTES", 1)
    monkeypatch.setattr("estimators.search.FEW_BYTES", 1)
    for pixels in (1, 30):
        monkeypatch.setattr("estimators.search.LEAST_PIXELS", pixels)
        parts = method(FixedWindow(1, 9)).estimate(pair)
        for name in ("delay", "coherence", "quality", "valid"):
            np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name))


@method
def test_single_precision_is_taken(make_patch, method):
    pair = make_patch(2, 48)
    single = replace(pair, primary=pair.primary.astype(np.complex64), secondary=pair.secondary.astype(np.complex64))
    double = method(FixedWindow(1, 33)).estimate(pair)
    np.testing.assert_allclose(method(FixedWindow(1, 33)).estimate(single).delay, double.delay, atol=1e-4 * WRAP)


@method
def test_it_is_an_estimator(method):
    assert isinstance(method(FixedWindow(1, 9)), Estimator)


@pytest.mark.parametrize("method", [CrossCorrelation, MaximumLikelihood])
def test_peaks_on_the_border_of_the_search_are_not_valid(make_patch, method):
    pair = make_patch(50, 63, coherence=0.99, delay=0.9 / 30e3, oversampling=1.0)
    estimate = method(FixedWindow(1, 63), search=0.5 / 30e3).estimate(pair)
    assert not estimate.valid.any()
    assert method(FixedWindow(1, 63), search=1.5 / 30e3).estimate(pair).valid.all()


@method
@pytest.mark.parametrize("scale", [1e-310, 5e-324])
def test_the_smallest_numbers_are_no_trap(make_patch, method, scale):
    pair = make_patch(2, 40, coherence=1.0)
    tiny = replace(pair, primary=scale * pair.primary, secondary=scale * pair.secondary)
    with np.errstate(all="ignore"):
        estimate = method(FixedWindow(1, 9)).estimate(tiny)
    for name in ("delay", "phase", *SHARES, "delay_std"):
        assert np.all(np.isfinite(getattr(estimate, name)[estimate.valid]))


@method
def test_the_phase_lies_in_its_interval(make_patch, method):
    pair = make_patch(2, 40, coherence=1.0)
    opposed = replace(pair, secondary=-pair.primary)
    phase = method(FixedWindow(1, 9)).estimate(opposed).phase
    assert np.all(phase > -np.pi)
    assert np.all(phase <= np.pi)


@method
@pytest.mark.parametrize("circular", [True, False])
def test_no_window_near_missing_samples_is_valid(make_patch, method, circular):
    pair = make_patch(7, 80, coherence=0.99, circular=circular)
    for rows, samples in ((slice(3, 4), slice(30, 36)), (slice(None), slice(None))):
        missing = np.zeros(pair.shape, dtype=bool)
        missing[rows, samples] = True
        series = {name: np.where(missing, 0, getattr(pair, name)) for name in ("primary", "secondary")}
        found = method(FixedWindow(3, 9)).estimate(replace(pair, **series, missing=missing))
        near = np.zeros(pair.shape, dtype=bool)
        if rows.start is None:
            near[:] = True
        else:
            # Half of 3 rows and of 9 samples, and the 2 samples of a resolution cell, to either side.
            near[2:5, 24:42] = True
        assert not found.valid[near].any()
        assert rows.start is None or found.valid[:, 50:70].any()
        for name in ("delay", "delay_std", *SHARES):
            assert np.isfinite(getattr(found, name)[found.valid]).all()
