"""The closed form of the full-band phase slope against the matrix that paper A defines it by."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.lag_product import extended, lag_product, upsampled


def matrix_definition(primary, secondary, delay):
    """Paper A, equations 7 to 18, for every time; `delay` in samples.

    The factor 2 pi and one 1/N that the paper leaves out are put in, and frequencies are taken around zero, so that the
    series are baseband. All 2N - 1 anti-diagonals are kept.
    """
    n = len(primary)
    harmonics = np.arange(n) - (n - 1) // 2
    times = np.arange(n)
    found = np.zeros(n, dtype=complex)
    spectrum_p = np.exp(-2j * np.pi * np.outer(harmonics, times) / n) @ primary / n
    spectrum_s = np.exp(-2j * np.pi * np.outer(harmonics, times) / n) @ secondary / n
    for t in times:
        q = spectrum_p * np.exp(2j * np.pi * harmonics * t / n)
        r = spectrum_s * np.exp(2j * np.pi * harmonics * t / n)
        matrix = np.outer(q.conj(), r)
        frequency = (harmonics[:, None] + harmonics[None, :]) / 2
        for a in np.unique(frequency):
            diagonal = matrix[frequency == a].sum()
            # The interferogram of the baseband rotates as exp(-i omega tau): the model's conjugate undoes that.
            found[t] += diagonal * np.exp(2j * np.pi * a * delay / n)
    return found


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 12), st.integers(1, 6), st.integers(-12, 12), st.integers(0, 2**32 - 1))
def test_lag_product_equals_the_matrix_definition(half, factor, lag, seed):
    samples = 2 * half + 1
    rng = np.random.default_rng(seed)
    primary, secondary = rng.normal(size=(2, samples)) + 1j * rng.normal(size=(2, samples))
    margin = 12
    planes = (extended(upsampled(series[None], factor), margin) for series in (primary.conj(), secondary))
    product = lag_product(*planes, lag)[0]
    direct = matrix_definition(primary, secondary, 2 * lag / factor)
    np.testing.assert_allclose(product, direct, atol=1e-10 * np.abs(direct).max())


@given(st.integers(1, 40), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_upsampling_interpolates_the_band(samples, factor, seed):
    rng = np.random.default_rng(seed)
    harmonics = np.arange(-((samples - 1) // 2), (samples - 1) // 2 + 1)
    spectrum = rng.normal(size=len(harmonics)) + 1j * rng.normal(size=len(harmonics))

    def series(times):
        return np.exp(2j * np.pi * np.outer(times, harmonics) / samples) @ spectrum

    planes = upsampled(series(np.arange(samples))[None], factor)
    for part, plane in enumerate(planes):
        np.testing.assert_allclose(plane[0], series(np.arange(samples) + part / factor), atol=1e-9)
