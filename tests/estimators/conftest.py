import numpy as np
import pytest

from sim import EchoPair, speckle_pair

FC = 100e3


@pytest.fixture(scope="session")
def make_patch():
    """Homogeneous speckle at a centre frequency of 100 kHz; what is left out is as in the signature."""

    def build(
        rows=3, samples=64, *, coherence=0.9, delay=0.0, relative_bandwidth=0.3, oversampling=1.5, seed=1, circular=True
    ):
        bandwidth = relative_bandwidth * FC
        pair = speckle_pair(
            (rows, samples),
            coherence=coherence,
            delay=delay,
            centre_frequency=FC,
            bandwidth=bandwidth,
            sample_rate=oversampling * bandwidth,
            rng=np.random.default_rng(seed),
        )
        return EchoPair(
            pair.primary, pair.secondary, pair.sample_rate, FC, bandwidth, truth=pair.truth, circular=circular
        )

    return build
