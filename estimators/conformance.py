"""What every estimator must do, tried on one of your own."""

import warnings
from collections.abc import Mapping

import numpy as np

from estimators.conformance_checks import CHECKS, Malformed, Trial, an_ordinary_pair
from estimators.estimate import Estimator
from estimators.windows import FixedWindow


def findings(
    estimator: Estimator, *, shape: tuple[int, int] = (9, 256), window: FixedWindow | None = None
) -> list[str]:
    """Say in words what an estimator does that none may do; an empty list if nothing was found.

    It is tried on simulated speckle at a relative bandwidth of 0.3, at a coherence of .95 and a delay of 0.2 wraps
    unless another is named:

    - it gives a `DelayEstimate` of arrays in the shape of the pair, real, `valid` of bool; so it does at a coherence of
      0 and of 1, of another shape, and of a record that is not periodic;
    - what is valid is finite, shares and probabilities lie in 0 to 1, the phase in -pi to pi, the spread is above
      0;
    - at a coherence of .95 some is valid; silence is not, nor are missing samples;
    - receivers swapped negate the delay; a common gain or phase changes nothing, nor does the layout in memory; 0.2
      wraps of delay more or less move the estimate by it (in the median, within 0.02 wraps);
    - single precision gives the same but for 1e-3 wraps, in all but 1 % of samples;
    - it leaves its input alone, the same pair gives the same, and so does one that comes after another (unless it holds
      a random generator);
    - rows further away than those of its window, where that is given, change nothing.

    Parameters
    ----------
    estimator
        Anything with `estimate(pair)`. It is copied for every trial, so that each finds it in the same state.
    shape
        (rows, samples) of the speckle, which must hold the estimator's window.
    window
        What the estimator was made with, for the last of the checks.

    Returns
    -------
    list
        One sentence a finding. Whatever it raises is a finding too; where it raises, or has not the form, on the first
        pair, nothing else is tried.
    """
    tried = examined(estimator, shape=shape, window=window)
    return distinct(tried)


def distinct(tried: Mapping[str, list[str]]) -> list[str]:
    """What all checks that were tried found, each finding once."""
    return list(dict.fromkeys(said for found in tried.values() for said in found))


def examined(
    estimator: Estimator, *, shape: tuple[int, int] = (9, 256), window: FixedWindow | None = None
) -> dict[str, list[str]]:
    """What each check that was tried found, by its name; parameters as of `findings`."""
    if not isinstance(estimator, Estimator):
        return {"a method": [f"{type(estimator).__name__} has no method estimate(pair)"]}
    trial, tried = Trial(estimator, shape, window), dict[str, list[str]]()
    for name, check in CHECKS.items():
        found = tried[name] = list[str]()
        try:
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("ignore")
                for said in check(trial):
                    found.append(said)
        except Malformed as wrong:
            found += wrong.args
        except (Exception, SystemExit) as error:  # Whatever a stranger's estimator does is to be told.
            found.append(f"{name}: it raised {type(error).__name__}: {error}")
        else:
            continue
        if check is an_ordinary_pair:
            break
    return tried
