"""The report of a study: one page that stands alone."""

import base64
import hashlib
import json
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from studies import manifest
from studies.html_table import all_of, listed, sortable
from studies.inline_svg import inline_svg
from studies.markup import text
from studies.study import Study


def page(
    study: Study,
    table: pd.DataFrame,
    answer: str,
    warnings: Sequence[str],
    figures: Mapping[str, Figure],
    folder: Path,
) -> str:
    """A page with question, answer, short table, figures, all numbers and how to get them again.

    It is HTML and well-formed XML in one. It asks for nothing from outside, which its content security policy also
    forbids, as it does any script but that which sorts the tables; all text of a study is escaped.

    Parameters
    ----------
    study
        The study.
    table
        Its table.
    answer
        What it says, in a sentence; may be empty.
    warnings
        What a reader must know of it.
    figures
        By name.
    folder
        Of the run, with its manifest.
    """
    found = manifest.read(folder)
    runs, script = found["runs"], _part("sort.js")
    return Template(_part("page.html")).substitute(
        name=text(study.name),
        question=text(study.question),
        answer=text(answer),
        warnings="".join(f'<p class="warning">{text(said)}</p>' for said in [*warnings, *_doubts(runs)]),
        short=sortable(study.summary.of(table)),
        figures="\n".join(_figure(f"f{number}-", *item) for number, item in enumerate(figures.items())),
        table=all_of(table),
        provenance=listed([("seed", found["seed"]), *_own_estimators(found["fixed"]), *_by_key(runs)]),
        code=text(_code(runs[-1])),
        seed=text(found["seed"]),
        design=text(json.dumps(found["study"], indent=2, ensure_ascii=False)),
        style=_part("style.css"),
        script=script,
        script_hash=f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}",
    )


def _part(name: str) -> str:
    return resources.files("studies").joinpath("page_parts", name).read_text(encoding="utf-8")


def _figure(prefix: str, name: str, figure: Figure) -> str:
    axes = [(axes.get_ylabel(), axes.get_xlabel()) for axes in figure.axes if axes.get_label() != "<colorbar>"]
    ys, xs = (list(dict.fromkeys(label for label in labels if label)) for labels in zip(*axes, strict=True))
    caption = name.replace("-", " ")
    caption += f": {', '.join(ys)} against {', '.join(xs)}" if ys and xs else ""
    box = f'<div class="wide" tabindex="0">{inline_svg(figure, prefix, caption)}</div>'
    return f"<figure>{box}<figcaption>{text(caption)}</figcaption></figure>"


def _by_key(runs: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    """What each run was made with, a row for each thing and a column for each run."""
    keys = dict.fromkeys(key for run in runs for key in run)
    return [[key, *("not known" if run.get(key) is None else run[key] for run in runs)] for key in keys]


def _own_estimators(fixed: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Estimators that are not of this package, each with its own package or the digest of its file."""
    estimators = [value for key, value in fixed.items() if key.startswith("estimators.")]
    return [(f"estimator {e['method']}", e["source"]) for e in estimators if e.get("source")]


def _doubts(runs: Sequence[Mapping[str, Any]]) -> list[str]:
    """What stands in the way of repeating a run."""
    commits = [run.get("commit") for run in runs]
    said = []
    if any(commit is None for commit in commits):
        said.append("it is not known from which commit all of the numbers come")
    if any(str(commit).endswith("-dirty") for commit in commits):
        said.append("some of the numbers come from code with changes that were not committed")
    if len(set(commits)) > 1:
        said.append(f"the numbers come from {len(set(commits))} states of the code")
    return said


def _code(run: Mapping[str, Any]) -> str:
    commit = run.get("commit")
    pinned = " ".join(f"{name}=={run[name]}" for name in manifest.PACKAGES if name in run)
    checkout = [f"git checkout {str(commit).removesuffix('-dirty')}"] if commit else []
    return "\n".join([*checkout, f"python -m pip install --editable . {pinned}"])
