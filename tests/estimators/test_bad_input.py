import pytest

from estimators import (
    CrossCorrelation,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: FixedWindow(1, 0), "samples of the window is 0; it must be a whole number of at least 1"),
        (lambda: FixedWindow(1.5, 3), r"rows of the window is 1\.5; it must be a whole number of at least 1"),
        (lambda: CrossCorrelation(FixedWindow(1, 9), lags_per_resolution=3), "lags_per_resolution is 3; .* at least 4"),
        (lambda: FullBandPhaseSlope(peak="last"), "peak is 'last'; it must be one of first, strongest"),
        (lambda: SplitSpectrum(FixedWindow(1, 9), sub_bandwidth=-2.0), "sub_bandwidth is -2 Hz; it must be above 0 Hz"),
        (lambda: MultiChromatic(FixedWindow(1, 9), bands=1), "bands is 1; it must be a whole number of at least 2"),
        (lambda: CrossCorrelation(FixedWindow(1, 9), refine="no"), "refine is 'no'; it must be true or false"),
        (lambda: SplitSpectrum(FixedWindow(1, 9), refine=0), "refine is 0; it must be true or false"),
        (lambda: MultiChromatic(FixedWindow(1, 9), refine=None), "refine is None; it must be true or false"),
        (lambda: FullBandPhaseSlope(refine="False"), "refine is 'False'; it must be true or false"),
        (lambda: TwoWindow(FixedWindow(1, 9)), r"wrap is FixedWindow\(.*\); it must be an estimator, .*"),
        (
            lambda: TwoWindow(Interferogram(), lags_per_resolution=2),
            "lags_per_resolution is 2; .* at least 4",
        ),
    ],
)
def test_estimators_that_cannot_be(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()


@pytest.mark.parametrize(
    ("estimator", "message"),
    [
        (CrossCorrelation(FixedWindow(1, 65)), "the window has 65 samples; the pair has 64, and it must not have more"),
        (Interferogram(FixedWindow(4, 1)), "the window has 4 rows; the pair has 3, and it must not have more"),
        (
            MultiChromatic(FixedWindow(1, 9), bands=43),
            "bands is 43; it must be at most 42, so that each holds a .* bin",
        ),
        (TwoWindow(Interferogram(), FixedWindow(4, 1)), "the window has 4 rows; the pair has 3, .*"),
        (CrossCorrelation(FixedWindow(1, 9), search=-1e-6), "search is -1e-06 s; it must be above 0 s"),
        (CrossCorrelation(FixedWindow(1, 9), search=1.0), "search is 1 s; it must not exceed half the record, .* s"),
        (SplitSpectrum(FixedWindow(1, 9), sub_bandwidth=2e4), "sub_bandwidth is 20000 Hz; .* half the band, 15000 Hz"),
        (
            SplitSpectrum(FixedWindow(1, 9), sub_bandwidth=1.0),
            "sub_bandwidth is 1 Hz; it must hold a Fourier bin, .* Hz",
        ),
    ],
)
def test_estimators_that_do_not_fit_the_pair(make_patch, estimator, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        estimator.estimate(make_patch())
