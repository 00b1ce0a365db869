"""The shipped estimators pass the suite for anybody's; estimators broken on purpose do not."""

import re
import sys
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
    assert findings(estimator, window=getattr(estimator, "window", None)) == []


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


def refuses_odd(pair):
    if pair.shape[1] % 2:
        sys.exit("an even number of samples, please")
    return pair


def nan_of_equals(estimate, pair):
    return np.where(estimate.coherence < 1 - 1e-9, estimate.wrap_error_probability, np.nan)


def as_if_contiguous(pair):
    """What code does that reads memory without asking how it is laid out."""
    series = {name: getattr(pair, name) for name in ("primary", "secondary")}
    return replace(pair, **{name: s.ravel(order="K").reshape(s.shape) for name, s in series.items()})


class Remembers:
    """Adds to each delay what it was asked before."""

    def __init__(self):
        self.before = 0.0

    def estimate(self, pair):
        estimate = Interferogram(WINDOW).estimate(pair)
        self.before, added = float(np.abs(pair.primary).sum()), self.before
        return replace(estimate, delay=estimate.delay + 1e-9 * added)


class Guesses:
    """Adds noise of a generator of its own, as an estimator with an argument `rng` may."""

    def __init__(self, spread):
        self.rng, self.spread = np.random.default_rng(1), spread

    def estimate(self, pair):
        estimate = Interferogram(WINDOW).estimate(pair)
        return replace(estimate, delay=estimate.delay * (1 + self.spread * self.rng.standard_normal()))


def writes(pair):
    pair.primary[:] = pair.primary.conj().conj() + 1e-3
    return pair


@pytest.mark.parametrize(
    ("estimator", "said"),
    [
        (object(), "has no method estimate"),
        (changed(delay=lambda e, p: e.delay[0]), r"delay has the shape \(256,\)"),
        (changed(quality=lambda e, p: 1.0), "quality is of type float; it must be an array"),
        (changed(delay=lambda e, p: e.delay + 0j), "delay is of type complex128; it must be float"),
        (changed(coherence=lambda e, p: np.ones(p.shape, dtype=int)), "coherence is of type int64; it must be float"),
        (changed(valid=lambda e, p: e.valid.astype(float)), "valid is of type float64; it must be bool"),
        (Broken(after=lambda e, p: (e.delay, e.valid)), "it gives a tuple without delay, phase, .* must give a Delay"),
        (Broken(after=lambda e, p: None), "it gives a NoneType without"),
        (changed(valid=lambda e, p: e.valid & False), "no sample of speckle"),
        (changed(delay=lambda e, p: np.where(e.phase > 1.26, e.delay, np.nan)), "delay is not finite but valid at"),
        (changed(delay_std=lambda e, p: e.delay_std + np.nan), "delay_std is not finite but valid at 1792 of 2304"),
        (changed(coherence=lambda e, p: 1.5 * e.coherence), "coherence is not between 0 and 1"),
        (changed(wrap_error_probability=lambda e, p: -e.quality), "wrap_error_probability is not between"),
        (changed(quality=lambda e, p: 2 * e.quality + 1), "quality is not between 0 and 1"),
        (changed(delay_std=lambda e, p: -e.delay_std), "delay_std is not above 0"),
        (changed(phase=lambda e, p: e.phase + 7), "phase is not within -pi and pi"),
        (
            changed(wrap_error_probability=nan_of_equals),
            r"at a coherence of 1, wrap_error_probability is not finite but valid at 1792 of 2304",
        ),
        (
            changed(quality=lambda e, p: e.quality + (np.median(e.coherence) < 0.5)),
            "at a coherence of 0, quality is not between 0 and 1",
        ),
        (Broken(before=refuses_odd), "another shape: it raised SystemExit: an even number of samples, please"),
        (changed(delay=lambda e, p: e.delay / (p.shape[0] == 9)), "of 10 x 257 samples, delay is not finite but valid"),
        (
            changed(delay=lambda e, p: e.delay / p.circular),
            "of a record that is not periodic, delay is not finite but valid",
        ),
        (changed(valid=lambda e, p: np.ones(p.shape, dtype=bool)), "valid where the primary is silent"),
        (changed(valid=lambda e, p: np.ones(p.shape, dtype=bool)), "valid where the secondary is silent"),
        (changed(valid=lambda e, p: np.ones(p.shape, dtype=bool)), "valid where both receivers are silent"),
        (
            changed(valid=lambda e, p: e.valid | (p.primary == 0) & p.primary.any()),
            "both receivers are silent from a time on at 1152 of 2304 samples",
        ),
        (
            changed(valid=lambda e, p: e.valid if p.missing is None else e.valid | p.missing),
            r"valid where samples are missing \(pair.missing\) at 43 of 2304 samples, the first at \(3, 85\)",
        ),
        (
            changed(delay=lambda e, p: e.delay / (p.missing is None), valid=lambda e, p: p.primary != 0),
            "where samples are missing, delay is not finite but valid",
        ),
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
        (Broken(before=as_if_contiguous), "another layout of the arrays in memory changes the delay"),
        (Broken(before=writes), "it changes the primary that it is given"),
        (
            changed(delay=lambda e, p: e.delay + 1e-9 * np.random.default_rng().standard_normal(p.shape)),
            "the same pair gives another estimate when it is asked again",
        ),
        (Remembers(), "what it gives depends on the pairs that it had before"),
        (changed(delay=lambda e, p: e.delay - e.delay.mean() / 2), "a row more than 3 rows away changes the delay"),
        (
            changed(valid=lambda e, p: e.valid & (np.arange(p.shape[1]) != np.abs(p.primary[0]).argmax())),
            "a row more than 3 rows away changes what is valid",
        ),
        (Interferogram(FixedWindow(1, 300)), "an ordinary pair: it raised ValueError: the window has 300 samples"),
    ],
)
def test_a_broken_one_is_found(estimator, said):
    found = findings(estimator, window=WINDOW)
    assert any(re.search(said, finding) for finding in found), found


def test_one_that_has_not_the_form_is_tried_no_further():
    assert len(findings(changed(delay=lambda e, p: e.delay[0], valid=lambda e, p: p.primary))) == 2
    assert len(findings(Interferogram(FixedWindow(1, 300)))) == 1


def test_a_generator_of_its_own_is_no_memory():
    assert findings(Guesses(1e-3)) == []


def test_a_window_may_need_more_speckle():
    estimator = Interferogram(FixedWindow(1, 300))
    assert findings(estimator)
    assert findings(estimator, shape=(2, 320)) == []
