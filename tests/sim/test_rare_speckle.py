"""Rare errors are drawn fairly: the likelihood ratios are those of the densities, and means remain those of nature."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim import DelayErrors, PhaseErrors, SubBandErrors, rare_speckle_pair

FC, B = 100e3, 30e3
ERRORS = {
    "delay": (DelayErrors(),),
    "sub-bands": (SubBandErrors(),),
    "phase": (PhaseErrors(0.3 / FC),),
    "phase, cancelled": (PhaseErrors(-0.1 / FC),),
    "all": (DelayErrors((1.0, 1.5), 3), SubBandErrors(B / 4, 3), PhaseErrors(-0.45 / FC)),
}
kind = pytest.mark.parametrize("errors", ERRORS.values(), ids=ERRORS)


def patch(rows=400, samples=9, *, coherence=0.9, delay=0.0, bandwidth=B, sample_rate=B, seed=1, **options):
    return rare_speckle_pair(
        (rows, samples),
        coherence=coherence,
        delay=delay,
        centre_frequency=FC,
        bandwidth=bandwidth,
        sample_rate=sample_rate,
        rng=np.random.default_rng(seed),
        **options,
    )


def lines(pair, samples):
    """Spectra of unit power without the delay, bins in order of frequency, and their frequencies."""
    frequencies = np.sort(np.fft.fftfreq(samples, 1 / pair.sample_rate))
    primary, secondary = (
        np.fft.fftshift(np.fft.fft(series), axes=1) / np.sqrt(samples) for series in (pair.primary, pair.secondary)
    )
    return primary, secondary * np.exp(2j * np.pi * (FC + frequencies) * pair.truth.delay), frequencies


@kind
@pytest.mark.parametrize("coherence", [0.2, 0.9, 0.999, 1 - 1e-9])
@pytest.mark.parametrize(("samples", "sample_rate"), [(9, B), (17, 1.8 * B)])
def test_the_mean_ratio_is_one_and_none_exceeds_its_bound(errors, coherence, samples, sample_rate):
    # Five standard errors of 20,000 ratios: a false-alarm rate of 6e-7 each. The outermost bins are full, or part full.
    options = {"sample_rate": sample_rate, "errors": errors, "plain_share": 0.3}
    ratio = patch(20_000, samples, coherence=coherence, **options).likelihood_ratio
    assert ratio.mean() == pytest.approx(1.0, abs=5 * ratio.std() / np.sqrt(ratio.size))
    assert ratio.max() <= 1 / 0.3
    assert ratio.min() >= 0


@kind
def test_weighted_means_are_those_of_plain_speckle(errors):
    coherence, rows = 0.8, 20_000
    pair = patch(rows, coherence=coherence, delay=2.2e-6, errors=errors)
    primary, secondary, _ = lines(pair, 9)
    cross = primary.conj() * secondary
    for values, expected in (
        (np.abs(primary) ** 2, 1.0),
        (np.abs(secondary) ** 2, 1.0),
        (cross.real, coherence),
        (cross.imag, 0.0),
    ):
        # Nine bins at six standard errors: a false-alarm rate of 2e-8.
        weighted = pair.likelihood_ratio[:, None] * values
        error = weighted.std(axis=0) / np.sqrt(rows)
        assert np.all(np.abs(weighted.mean(axis=0) - expected) < 6 * error)


def test_the_ratio_is_that_of_the_densities():
    # A plain twin: 2 x 2 covariances bin by bin, half the precision of truth and rival, the mixture summed up.
    coherence, share, looks = 0.7, 0.25, 5
    kinds = (DelayErrors((1.0,)), SubBandErrors(divisions=3))
    pair = patch(50, looks, coherence=coherence, delay=1.3e-6, errors=kinds, plain_share=share)
    primary, secondary, frequencies = lines(pair, looks)
    both = np.stack([primary, secondary], axis=-1)

    def precision(phase):
        return np.linalg.inv([[1, coherence * np.exp(-1j * phase)], [coherence * np.exp(1j * phase), 1]])

    def log_density(precisions):
        form = np.einsum("rki,kij,rkj->rk", both.conj(), precisions, both).real
        return (np.linalg.slogdet(precisions)[1] - form).sum(axis=1)

    edge = np.abs(frequencies) > B / 2 - B / 3
    apart = 2 * np.pi / 3 * B / FC
    turns = [
        [sign * 2 * np.pi / FC * (frequencies - f0) for sign in (-1, 1) for f0 in frequencies],
        [sign * edge * (np.sign(frequencies) * apart + u) for sign in (-1, 1) for u in (-apart, 0, apart)],
    ]
    truth = log_density(np.array([precision(0.0)] * looks))
    drawn = share * np.exp(truth)
    for rivals in turns:
        half = [np.array([(precision(0.0) + precision(phase)) / 2 for phase in rival]) for rival in rivals]
        determinant = np.linalg.det(precision(0.0)).real
        chernoff = np.array([np.prod(determinant / np.linalg.det(each).real) for each in half])
        densities = np.exp([log_density(each) for each in half])
        drawn += (1 - share) / len(turns) * chernoff @ densities / chernoff.sum()
    np.testing.assert_allclose(pair.likelihood_ratio, np.exp(truth) / drawn, rtol=1e-9)


def test_the_same_seed_gives_the_same_bits():
    first, second = patch(seed=7), patch(seed=7)
    for name in ("primary", "secondary", "likelihood_ratio"):
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


@kind
def test_without_coherence_all_rows_are_plain(errors):
    np.testing.assert_allclose(patch(coherence=0.0, errors=errors).likelihood_ratio, 1.0, rtol=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    coherence=st.one_of(st.floats(0.0, 1 - 1e-12), st.floats(3.0, 12.0).map(lambda x: 1 - 10**-x)),
    looks=st.sampled_from([1, 2, 3, 9, 200]),
    relative_bandwidth=st.sampled_from([1e-4, 0.3, 1.9]),
    oversampling=st.sampled_from([1.0, 1.3, 3.0]),
    delay=st.floats(-0.5, 0.5),
    plain_share=st.floats(0.01, 0.99),
    seed=st.integers(0, 2**32 - 1),
)
def test_ratios_are_finite_and_bounded(coherence, looks, relative_bandwidth, oversampling, delay, plain_share, seed):
    bandwidth = relative_bandwidth * FC
    pair = patch(
        40,
        int(np.ceil(looks * oversampling)),
        coherence=coherence,
        bandwidth=bandwidth,
        sample_rate=oversampling * bandwidth,
        delay=delay / FC,
        errors=(DelayErrors(), SubBandErrors(), PhaseErrors(delay / FC)),
        plain_share=plain_share,
        seed=seed,
    )
    assert np.all(np.isfinite(pair.primary))
    assert np.all((pair.likelihood_ratio >= 0) & (pair.likelihood_ratio <= 1 / plain_share))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"coherence": 1.0}, "coherence is 1; it must be below 1, where noise makes errors"),
        ({"coherence": -0.1}, "coherence is -0.1; it must lie between 0 and 1"),
        ({"plain_share": 0.0}, "plain_share is 0; it must lie between 0.01 and 0.99"),
        ({"errors": ()}, "errors is empty; it must name at least one kind of error"),
        ({"errors": (SubBandErrors(2e4),)}, "sub_bandwidth is 20000 Hz; it must lie between 0 and 15000 Hz"),
        ({"errors": (PhaseErrors(1e-5),)}, "delay is 1e-05 s; it must lie between -5e-06 and 5e-06 s"),
        ({"sample_rate": 1e4}, "sample_rate is 10000 Hz; it must be at least the bandwidth, 30000 Hz"),
    ],
)
def test_bad_values_are_named(change, message):
    with pytest.raises(ValueError, match=message.replace(".", r"\.")):
        patch(**change)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: DelayErrors((1.0, 0.0)), "wraps is 0; it must be above 0"),
        (lambda: DelayErrors(()), "wraps is empty; it must name at least one"),
        (lambda: SubBandErrors(-1.0), "sub_bandwidth is -1 Hz; it must be above 0 Hz"),
        (lambda: PhaseErrors(np.nan), "delay is nan; it must be finite"),
        (
            lambda: replace(patch(3), likelihood_ratio=np.ones(2)),
            r"likelihood_ratio has the shape \(2,\); it must have one number for each of the 3 rows",
        ),
        (lambda: replace(patch(3), likelihood_ratio=[1, -2, 1]), "likelihood_ratio has the value -2; .* below 0"),
        (lambda: replace(patch(3), likelihood_ratio=[1, np.inf, 1]), "likelihood_ratio has 1 samples .* not finite"),
    ],
)
def test_what_cannot_be_is_refused(build, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        build()
