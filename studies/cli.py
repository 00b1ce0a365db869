"""The command `twinecho`."""

import os
import sys
import warnings

import typer

from studies.allocation import keep_freed_memory
from studies.commands.check_estimator import check_estimator
from studies.commands.estimate import estimate
from studies.commands.look import check, list_studies
from studies.commands.predict import predict
from studies.commands.runs import merge, replay, report_again, run, status
from studies.commands.tune import tune

app = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.callback()
def twinecho() -> None:
    """Monte Carlo studies of absolute delay estimation in interferometric synthetic aperture sonar."""


for name, command in (
    ("list", list_studies),
    ("check", check),
    ("run", run),
    ("status", status),
    ("report", report_again),
    ("replay", replay),
    ("merge", merge),
    ("predict", predict),
    ("tune", tune),
    ("estimate", estimate),
    ("check-estimator", check_estimator),
):
    app.command(name)(command)


def main() -> None:
    """Run the command line."""
    warnings.showwarning = _one_line_warning
    # What a study file names may lie beside it.
    sys.path.insert(0, os.getcwd())
    keep_freed_memory()
    app()


def _one_line_warning(message: Warning | str, *_: object, **__: object) -> None:
    print(f"twinecho: warning: {' '.join(str(message).split())}", file=sys.stderr)
