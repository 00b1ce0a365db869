"""Every estimator over all of the ranges that `estimators.extremes` promises, in any combination."""

import re
from dataclasses import fields, replace

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from estimators import (
    CombinedNeighbours,
    CrossCorrelation,
    DelayEstimate,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
    extremes,
)
from sim import EchoPair, speckle_pair

FC = 100e3
WRAP = 1 / FC

METHODS = {
    "interferogram": Interferogram,
    "cross-correlation": CrossCorrelation,
    "cross-correlation-group": lambda window: CrossCorrelation(window, refine=False),
    "split-spectrum": SplitSpectrum,
    "multi-chromatic": lambda window: MultiChromatic(window, bands=3),
    "maximum-likelihood": MaximumLikelihood,
    "phase-slope": lambda window: FullBandPhaseSlope(window, lags_per_resolution=8),
    "two-window": lambda window: TwoWindow(CrossCorrelation(window)),
    "combined": lambda window: CombinedNeighbours(CrossCorrelation(window), std=0.05 * WRAP),
    "combined-pixels": lambda window: CombinedNeighbours(FullBandPhaseSlope(lags_per_resolution=8), std=0.05 * WRAP),
}
method = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)

DOUBLE, SINGLE = (np.log10(limits) for limits in (extremes.AMPLITUDE, extremes.SINGLE_AMPLITUDE))

COHERENCE = st.one_of(
    st.floats(*extremes.SNR).map(lambda snr: 1 / (1 + 10 ** (-snr / 10))),
    st.sampled_from([0.0, 1e-150, 1 - 2**-53, 1.0]),
)
BANDWIDTH = st.one_of(
    # A few, as the predicted wrap errors of each are tabulated once.
    st.sampled_from([extremes.RELATIVE_BANDWIDTH[0], 0.01, 0.1, 0.3, 0.6, 1.2, extremes.RELATIVE_BANDWIDTH[1]])
)
SPOILED = st.sampled_from(
    ["not", "not", "gaps", "silent part", "silent row", "silent receiver", "spike", "constant", "tone"]
)


@st.composite
def pairs(draw):
    """Echoes at any combination of extremes, with a window that fits them."""
    rows, samples = draw(st.integers(1, 4)), draw(st.sampled_from([1, 2, 5, 12, 13, 33, 48]))
    band = draw(BANDWIDTH) * FC
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    pair = speckle_pair(
        (rows, samples),
        coherence=draw(COHERENCE),
        delay=draw(st.floats(-0.5, 0.5)) / draw(st.sampled_from([FC, band])),
        centre_frequency=FC,
        bandwidth=band,
        sample_rate=draw(st.sampled_from([1.0, 4 / 3, 2.0] if samples > 1 else [1.0])) * band,
        rng=rng,
    )
    how = draw(SPOILED)
    primary, secondary = _spoiled(how, pair.primary.copy(), pair.secondary.copy(), rng)
    limits, kind = draw(st.sampled_from([(DOUBLE, np.complex128), (SINGLE, np.complex64)]))
    first, second = (draw(st.one_of(st.sampled_from([*limits, 0.0]), st.floats(*limits))) for _ in range(2))
    primary, secondary = _in(kind, 10.0**first, primary), _in(kind, 10.0**second, secondary)
    if how == "gaps":
        primary[rng.uniform(size=primary.shape) < rng.choice([0.05, 0.3, 1.0])] = rng.choice([np.nan, np.inf])
    echoes = EchoPair.with_gaps(primary, secondary, pair.sample_rate, FC, band)
    window = FixedWindow(
        draw(st.integers(1, rows)), draw(st.one_of(st.sampled_from([1, samples]), st.integers(1, samples)))
    )
    return replace(echoes, circular=draw(st.booleans())), window


def _in(kind, amplitude, series):
    return (np.asarray(amplitude, kind(0).real.dtype) * series).astype(kind)


def _spoiled(how, primary, secondary, rng):
    middle = primary.shape[1] // 2
    if how == "silent part":
        primary[:, : middle + 1], secondary[:, middle:] = 0, 0
    elif how == "silent row":
        secondary[0] = 0
    elif how == "silent receiver":
        secondary[:] = 0
    elif how == "spike":
        # What single precision holds at the largest amplitude.
        secondary[0, middle] *= rng.choice([1e2, 1e4, 1e7])
    elif how == "constant":
        primary[:], secondary[:] = 1, rng.choice([1, -1, 1j])
    elif how == "tone":
        turns = rng.integers(0, primary.shape[1]) * np.arange(primary.shape[1]) / primary.shape[1]
        primary[:] = secondary[:] = np.exp(2j * np.pi * turns)
    return primary, secondary


def estimated(method, window, pair):
    """An estimate; what a method cannot take it says in one line."""
    try:
        return method(window).estimate(pair)
    except ValueError as error:
        if not re.search(r"^(sub_bandwidth|bands) is .* hold(s)? a Fourier bin", str(error)):
            raise
        return assume(False)


@method
@settings(max_examples=15, deadline=None)
@given(given_=pairs())
def test_nothing_is_valid_of_a_form_that_cannot_be(method, given_):
    pair, window = given_
    estimate = estimated(method, window, pair)
    for field in fields(DelayEstimate):
        assert getattr(estimate, field.name).shape == pair.shape
    assert not extremes.broken(estimate).any()
    if not pair.primary.any() or not pair.secondary.any():
        assert not estimate.valid.any()


@method
@settings(max_examples=6, deadline=None)
@given(
    coherence=COHERENCE,
    relative_bandwidth=BANDWIDTH,
    samples=st.sampled_from([5, 13, 33]),
    share=st.sampled_from([1.0, 0.3]),
    circular=st.booleans(),
    exponent=st.sampled_from([*DOUBLE, 0.0]),
    seed=st.integers(0, 2**32 - 1),
)
def test_claims_hold(method, coherence, relative_bandwidth, samples, share, circular, exponent, seed):
    """Fails at a chance of one in a million of either claim of an example: 1.2e-4 over all, of what claims allow."""
    rng, band = np.random.default_rng(seed), relative_bandwidth * FC
    # Within half a wrap, and within what the split spectrum can tell, 0.75 / B.
    delay = rng.uniform(-0.5, 0.5, 100) * min(WRAP, 1.5 / band)
    pair = speckle_pair(
        (100, samples),
        coherence=coherence,
        delay=delay,
        centre_frequency=FC,
        bandwidth=band,
        sample_rate=band,
        rng=rng,
    )
    loud = replace(
        pair, primary=10.0**exponent * pair.primary, secondary=10.0**exponent * pair.secondary, circular=circular
    )
    estimate = estimated(method, FixedWindow(1, max(int(share * samples), 1)), loud)
    found = extremes.tally(estimate, delay, FC, samples // 2)
    assert found.holds, found


@method
@settings(max_examples=6, deadline=None)
@given(given_=pairs(), power=st.integers(-20, 20), other=st.integers(-20, 20))
def test_powers_of_two_change_no_bit(method, given_, power, other):
    pair, window = given_
    kind = pair.primary.dtype.type
    # A spike at the largest amplitude times 2^20 has no number in single precision.
    assume(max(np.abs(pair.primary).max(), np.abs(pair.secondary).max()) < np.finfo(kind).max / 2.0**21)
    scaled = replace(pair, primary=kind(2.0**power) * pair.primary, secondary=kind(2.0**other) * pair.secondary)
    least = 2.0**20 * np.finfo(kind).tiny
    for one in (pair, scaled):
        # Exact only as long as nothing is rounded to a multiple of the smallest number.
        parts = np.abs(np.stack([one.primary, one.secondary]).view(one.primary.real.dtype))
        assume(not ((parts > 0) & (parts < least)).any())
    before, after = (estimated(method, window, one) for one in (pair, scaled))
    for field in fields(DelayEstimate):
        np.testing.assert_array_equal(getattr(after, field.name), getattr(before, field.name), err_msg=field.name)


def test_claims_may_be_short_by_two_derived_cases_and_no_more():
    """An interferogram at exactly half a wrap, which claims `atan(1/sqrt(2)) / pi` on average for one half, and group
    delays beside a spike, `sqrt(3) fs / B` times as spread, at `fs = 4/3 B`."""
    half, spike = 0.5 / (np.arctan(np.sqrt(0.5)) / np.pi), np.sqrt(3) * 4 / 3
    assert max(half, spike) <= extremes.SHORT < 1.02 * max(half, spike)


@method
def test_a_record_that_was_padded_tells_nothing_where_it_is_silent(make_patch, method):
    """Of echoes that end, what lies beyond is the tail of the last, alike at both receivers. Fails at 1e-6 a place."""
    pair = make_patch(300, 128, coherence=0.9, delay=0.2 * WRAP)
    heard = np.arange(128) < 90
    padded = replace(pair, primary=pair.primary * heard, secondary=pair.secondary * heard, circular=False)
    estimate = method(FixedWindow(1, 17)).estimate(padded)
    assert not estimate.valid[:, ~heard].any()
    assert estimate.valid[:, 40].any()
    for column in range(60, 90):
        assert extremes.tally(estimate, 0.2 * WRAP, FC, column).holds, column


@pytest.mark.parametrize("circular", [False, True])
def test_silence_is_a_run_of_zeros_in_either_receiver(make_patch, circular):
    pair = make_patch(6, 60, coherence=0.9)
    cell = int(np.ceil(pair.sample_rate / pair.bandwidth))
    run = 2 * cell + 1
    secondary = pair.secondary.copy()
    secondary[0, 20 : 20 + run] = 0
    secondary[1, 20 : 19 + run] = 0  # one less
    secondary[2, [0, 1, 2, 40, 42, 44]] = 0  # apart, or as long as a run only across the ends
    secondary[2, 57:] = 0
    secondary[3] = 0
    inside = FixedWindow(2, 3).inside(replace(pair, secondary=secondary, circular=circular))
    plain = FixedWindow(2, 3).inside(replace(pair, circular=circular))
    expected = plain.copy()
    assert 3 < run <= 6
    for row in (0, 2, 3) if circular else (0, 3):
        at = {0: range(20, 20 + run), 2: [57, 58, 59, 0, 1, 2], 3: range(60)}[row]
        for place in at:
            for beside in range(-1 - cell, 2 + cell):
                # A window of two rows reaches one back, one of three samples a sample to either side.
                time = (place + beside) % 60 if circular else place + beside
                if 0 <= time < 60:
                    expected[row : row + 2, time] = False
    np.testing.assert_array_equal(inside, expected)


@method
def test_rows_too_dark_for_squares_beside_others_are_not_valid(make_patch, method):
    """At 1e-90 of the brightest, maximum likelihood claimed .0033 of the wraps for .093 that were wrong."""
    pair = make_patch(300, 64, coherence=0.8, delay=0.2 * WRAP)
    for darker in (1e-70, 1e-80, 1e-90, 1e-150):
        strength = np.where(np.arange(300) > 0, darker, 1.0)[:, None]
        dark = replace(pair, primary=pair.primary * strength, secondary=pair.secondary * strength)
        estimate = method(FixedWindow(1, 17)).estimate(dark)
        assert not extremes.broken(estimate).any()
        assert extremes.tally(estimate, 0.2 * WRAP, FC, 32).holds
        if darker < 1e-76:
            assert not estimate.valid[1:].any()


@method
@pytest.mark.parametrize("kind", [np.complex64, np.complex128])
def test_numbers_too_few_of_the_smallest_are_no_echo(make_patch, method, kind):
    """Rounded to whole ones, receivers agree on phases that are not theirs: 22 of 35 intervals missed the delay."""
    pair = make_patch(2, 40, coherence=1.0, delay=0.1 * WRAP)
    least = np.finfo(kind).smallest_subnormal
    for number, valid in ((3, False), (1e6, True)):
        tiny = [
            (np.round(number * np.stack([x.real, x.imag], -1)).astype(least.dtype) * least).view(kind)[..., 0]
            for x in (pair.primary, pair.secondary)
        ]
        found = method(FixedWindow(1, 9)).estimate(replace(pair, primary=tiny[0], secondary=tiny[1])).valid
        assert found.any() == valid


@pytest.mark.parametrize(("lags", "least"), [(4, 2e-5), (8, 1e-7), (32, 1e-12)])
@pytest.mark.parametrize("coherence", [0.9, 1 - 1e-12, 1.0])
def test_peaks_are_those_of_50_digits(coherence, lags, least):
    """Of whole records, `C(tau) = sum P_k* S_k exp(2 pi i f_k tau)`, its peak by Newton's method in 50 digits."""
    band = 30e3
    pair = speckle_pair(
        (6, 15),
        coherence=coherence,
        delay=0.3 * WRAP,
        centre_frequency=FC,
        bandwidth=band,
        sample_rate=band,
        rng=np.random.default_rng(7),
    )
    loud = replace(pair, primary=1e150 * pair.primary, secondary=1e-150 * pair.secondary)
    estimate = CrossCorrelation(FixedWindow(1, 15), refine=False, lags_per_resolution=lags).estimate(loud)
    with mpmath.workdps(50):
        for row in range(6):
            lines = _spectrum(pair.primary[row]), _spectrum(pair.secondary[row])
            energy = mpmath.sqrt(_power(lines[0]) * _power(lines[1]))
            cross = [mpmath.conj(p) * s / energy for p, s in zip(*lines, strict=True)]
            # In wraps.
            delay = mpmath.mpf(estimate.delay[row, 0]) * FC
            peak = mpmath.findroot(lambda tau, c=cross: _slope(c, tau), (delay - 1e-4, delay + 1e-4), tol=1e-70)
            assert abs(peak - delay) < least
            value = mpmath.fsum(c * _turn(k, peak) for k, c in zip(LINES, cross, strict=True))
            assert abs(estimate.coherence[row, 0] - abs(value)) < least


LINES, RELATIVE = range(-7, 8), mpmath.mpf(3) / 10


def _turn(line, wraps):
    """`exp(2 pi i f tau)` of a line of 15 over a band of 0.3."""
    return mpmath.expj(2 * mpmath.pi * line * RELATIVE / 15 * wraps)


def _spectrum(series):
    turn = -2 * mpmath.pi / len(series)
    return [mpmath.fsum(x * mpmath.expj(turn * k * n) for n, x in enumerate(series.tolist())) for k in LINES]


def _slope(cross, wraps):
    """Derivative of `|C|^2`, but for a factor."""
    terms = [c * _turn(k, wraps) for k, c in zip(LINES, cross, strict=True)]
    bent = mpmath.fsum(1j * k * x for k, x in zip(LINES, terms, strict=True))
    return (mpmath.conj(mpmath.fsum(terms)) * bent).real


def _power(lines):
    return mpmath.fsum(abs(x) ** 2 for x in lines)
