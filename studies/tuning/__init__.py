"""The cheapest setting of an estimator that meets a tolerance."""

from studies.tuning.condition import Condition, Tolerance
from studies.tuning.judged import Judged
from studies.tuning.target import Target, target_of
from studies.tuning.tune import QUICK, USUAL, Effort, Tuned, tune, tuned

__all__ = [
    "QUICK",
    "USUAL",
    "Condition",
    "Effort",
    "Judged",
    "Target",
    "Tolerance",
    "Tuned",
    "target_of",
    "tune",
    "tuned",
]
