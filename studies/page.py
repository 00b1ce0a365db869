"""The report of a study: one page that stands alone."""

import base64
import html
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from string import Template
from typing import Any

import pandas as pd
from matplotlib import rc_context
from matplotlib.figure import Figure

from studies import manifest
from studies.study import Study

PAGE = Template("""<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>$name</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; background: #fff; }
body { max-width: 76rem; margin: 0 auto; padding: 1rem; }
img { max-width: 100%; height: auto; }
figure { margin: 2rem 0; }
figcaption { color: #444; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.2rem 0.6rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap; }
th { position: sticky; top: 0; background: #f4f4f4; }
th button { font: inherit; font-weight: 600; border: 0; background: none; padding: 0; cursor: pointer; }
.warning { border-left: 4px solid #d55e00; padding-left: 0.8rem; }
pre { overflow-x: auto; background: #f4f4f4; padding: 0.8rem; }
</style>
<h1>$name</h1>
<p>$question</p>
$warnings
<p><strong>$answer</strong></p>
<h2>In short</h2>
<div class="wide">$short</div>
$figures
<details><summary><h2 style="display: inline">All numbers</h2></summary>
<div class="wide">$table</div></details>
<h2>Where it comes from</h2>
<div class="wide"><table>$provenance</table></div>
<h2>How to repeat it</h2>
<p>In the folder of this page, with the command of the environment that twinecho is installed in:</p>
<pre>$command</pre>
<details><summary>The study, as it was run</summary><pre>$design</pre></details>
<script>
for (const table of document.querySelectorAll("table.sortable")) {
  table.querySelectorAll("th button").forEach((button, column) => button.addEventListener("click", () => {
    const rows = [...table.tBodies[0].rows], down = button.dataset.down !== "yes";
    const value = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
    rows.sort((a, b) => {
      const x = value(a), y = value(b), difference = x - y;
      return (Number.isNaN(difference) ? String(x).localeCompare(String(y)) : difference) * (down ? 1 : -1);
    });
    button.dataset.down = down ? "yes" : "no";
    table.tBodies[0].append(...rows);
  }));
}
</script>
</html>
""")


def page(
    study: Study,
    table: pd.DataFrame,
    answer: str,
    warnings: Sequence[str],
    figures: Mapping[str, Figure],
    folder: Path,
) -> str:
    """A page with question, answer, short table, figures, all numbers and how to get them again; no outside links.

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
    provenance = [("seed", found["seed"]), *(item for run in found["runs"] for item in run.items())]
    return PAGE.substitute(
        name=html.escape(study.name),
        question=html.escape(study.question),
        answer=html.escape(answer),
        warnings="".join(f'<p class="warning">{html.escape(text)}</p>' for text in warnings),
        short=_table(study.summary.of(table)),
        figures="".join(_figure(name, figure) for name, figure in figures.items()),
        table=_table(table),
        provenance="".join(f"<tr><th>{_text(k)}<td>{_text(v)}" for k, v in provenance),
        command=f"twinecho run manifest.json --seed {found['seed']} --out again",
        design=html.escape(_design(found["study"])),
    )


def _figure(name: str, figure: Figure) -> str:
    drawn = io.BytesIO()
    with rc_context({"svg.hashsalt": "twinecho"}):  # the same figure, the same bytes
        figure.savefig(drawn, format="svg", metadata={"Date": None})
    data = base64.b64encode(drawn.getvalue()).decode()
    caption = html.escape(name.replace("-", " "))
    image = f'<img alt="{caption}" src="data:image/svg+xml;base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _table(table: pd.DataFrame) -> str:
    head = "".join(f'<th><button type="button">{_text(column)}</button>' for column in table.columns)
    body = "".join("<tr>" + "".join(_cell(value) for value in row) for row in table.itertuples(index=False))
    return f'<table class="sortable"><thead><tr>{head}<tbody>{body}</table>'


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f'<td data-value="{value!r}">{value:.4g}'
    return f"<td>{_text(value)}"


def _text(value: Any) -> str:
    return html.escape(str(value))


def _design(tree: Mapping[str, Any]) -> str:
    lines = []
    for key, value in tree.items():
        lines += (
            [f"{key}.{inner} = {v!r}" for inner, v in value.items()]
            if isinstance(value, dict)
            else [f"{key} = {value!r}"]
        )
    return "\n".join(lines)
