"""Band-limited interpolation, on which the lag product stands; the product itself is tested as one of a family."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from estimators.lag_product import upsampled


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
