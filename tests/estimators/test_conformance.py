"""The shipped estimators pass the suite for anybody's; estimators broken on purpose do not."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

from estimators import (
    CrossCorrelation,
    FixedWindow,
    FullBandPhaseSlope,
    Interferogram,
    MaximumLikelihood,
    MultiChromatic,
    SplitSpectrum,
    TwoWindow,
)
from estimators.conformance import findings

WINDOW = FixedWindow(3, 33)
SHIPPED = [
    Interferogram(),
    Interferogram(WINDOW),
    CrossCorrelation(WINDOW),
    CrossCorrelation(FixedWindow(1, 9), refine=False),
    SplitSpectrum(WINDOW),
    SplitSpectrum(WINDOW, sub_bandwidth=15e3, refine=False),
    MultiChromatic(WINDOW),
    MultiChromatic(WINDOW, bands=2, refine=False),
    FullBandPhaseSlope(),
    FullBandPhaseSlope(peak="strongest", refine=False),
    MaximumLikelihood(WINDOW),
    TwoWindow(CrossCorrelation(WINDOW)),
    TwoWindow(MultiChromatic(WINDOW), FixedWindow(1, 4)),
]


@pytest.mark.parametrize("estimator", SHIPPED, ids=lambda e: type(e).__name__)
def test_shipped_estimators_have_no_findings(estimator):
    assert findings(estimator) == []


@dataclass(frozen=True)
class Broken:
    """An interferogram whose input and output are tampered with."""

    before: object = staticmethod(lambda pair: pair)
    after: object = staticmethod(lambda estimate, pair: estimate)

    def estimate(self, pair):
        return self.after(Interferogram(WINDOW).estimate(self.before(pair)), pair)


def changed(**made):
    return Broken(after=lambda estimate, pair: replace(estimate, **{k: f(estimate, pair) for k, f in made.items()}))


def refuses_single(pair):
    if pair.primary.dtype == np.complex64:
        raise TypeError("double precision, please")
    return pair


def writes(pair):
    pair.primary[:] = pair.primary.conj().conj() + 1e-3
    return pair


@pytest.mark.parametrize(
    ("estimator", "said"),
    [
        (object(), "has no method estimate"),
        (changed(delay=lambda e, p: e.delay[0]), r"delay has the shape \(256,\)"),
        (changed(valid=lambda e, p: e.valid.astype(float)), "valid is of type float64"),
        (changed(valid=lambda e, p: e.valid & False), "no sample of speckle"),
        (changed(delay=lambda e, p: np.where(e.phase > 1.26, e.delay, np.nan)), "delay is not finite but valid at"),
        (changed(delay_std=lambda e, p: e.delay_std + np.nan), "delay_std is not finite but valid at 1792 of 2304"),
        (changed(coherence=lambda e, p: 1.5 * e.coherence), "coherence is not between 0 and 1"),
        (changed(wrap_error_probability=lambda e, p: -e.quality), "wrap_error_probability is not between"),
        (changed(quality=lambda e, p: 2 * e.quality + 1), "quality is not between 0 and 1"),
        (changed(delay_std=lambda e, p: -e.delay_std), "delay_std is below 0"),
        (changed(phase=lambda e, p: e.phase + 7), "phase is not within -pi and pi"),
        (changed(valid=lambda e, p: np.ones(p.shape, dtype=bool)), "valid where both receivers are silent"),
        (changed(delay=lambda e, p: np.abs(e.delay)), "receivers swapped do not negate the delay"),
        (changed(delay=lambda e, p: e.delay + 1e-8), "receivers swapped do not negate the delay"),
        (changed(valid=lambda e, p: np.abs(p.primary) > 0.1), "receivers swapped change what is valid"),
        (changed(delay=lambda e, p: e.delay * np.abs(p.primary).max()), "a common gain of 1e6 changes the delay"),
        (changed(delay=lambda e, p: e.delay + 1e-7 * np.angle(p.primary)), "a common phase of 1 rad changes the delay"),
        (
            changed(coherence=lambda e, p: np.minimum(np.abs(p.primary), 1)),
            "a common gain of 1e6 changes the coherence",
        ),
        (changed(valid=lambda e, p: np.abs(p.primary) > 0.1), "a common gain of 1e-6 changes what is valid"),
        (changed(delay=lambda e, p: -e.delay), r"a delay of 0\.2 wraps more moves the median estimate by -0\.2 wraps"),
        (changed(delay=lambda e, p: 1.2 * e.delay), r"moves the median estimate by 0\.24 wraps"),
        (changed(delay=lambda e, p: 0 * e.delay), "moves the median estimate by 0 wraps"),
        (changed(delay=lambda e, p: e.delay * (1 + (p.primary.dtype == np.complex64))), "single precision gives anoth"),
        (Broken(before=refuses_single), "single precision: it raised TypeError: double precision, please"),
        (Broken(before=writes), "it changes the primary that it is given"),
        (Interferogram(FixedWindow(1, 300)), "an ordinary pair: it raised ValueError: the window has 300 samples"),
    ],
)
def test_a_broken_one_is_found(estimator, said):
    found = findings(estimator)
    assert any(re.search(said, finding) for finding in found), found


def test_a_window_may_need_more_speckle():
    estimator = Interferogram(FixedWindow(1, 300))
    assert findings(estimator)
    assert findings(estimator, shape=(2, 320)) == []
