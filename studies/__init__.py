"""Questions: sweeps, tables, plots, the command line."""

from studies.engine import Run, Share, run, store_of
from studies.prediction import predict
from studies.report import Result, result, write
from studies.study import Study, load
from studies.tuning import Tuned, tune

__all__ = ["Result", "Run", "Share", "Study", "Tuned", "load", "predict", "result", "run", "store_of", "tune", "write"]
