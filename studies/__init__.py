"""Questions: sweeps, tables, plots, the command line."""

from studies.engine import Run, Share, run, store_of
from studies.prediction import predict
from studies.report import Result, result, write
from studies.study import Study, load

__all__ = ["Result", "Run", "Share", "Study", "load", "predict", "result", "run", "store_of", "write"]
