"""Tables of a page, which a reader can sort."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from pandas.api.types import is_bool_dtype, is_numeric_dtype

from studies.markup import text

MOST_CELLS = 40_000
"""Cells of a table in a page; what has more would make the page slow."""

TEXT = ' class="text"'


def sortable(table: pd.DataFrame) -> str:
    """A table whose columns a click on their head sorts; numbers have four digits, and what is not one is empty."""
    numbers = [is_numeric_dtype(kind) and not is_bool_dtype(kind) for kind in table.dtypes]
    kinds = ["" if number else TEXT for number in numbers]
    head = "".join(
        f'<th scope="col"{kind}>{text(column)}</th>' for kind, column in zip(kinds, table.columns, strict=True)
    )
    body = "\n".join(
        f"<tr>{''.join(f'<td{kind}>{_cell(value)}</td>' for kind, value in zip(kinds, row, strict=True))}</tr>"
        for row in table.itertuples(index=False, name=None)
    )
    return _boxed(f'<table class="sortable"><thead><tr>{head}</tr></thead><tbody>\n{body}</tbody></table>')


def all_of(table: pd.DataFrame) -> str:
    """A table of many columns: those of one value in a sentence, the others `sortable`, and of many rows the first."""
    alike = [column for column in table.columns if len(table) > 1 and table[column].nunique(dropna=False) == 1]
    varied = table.drop(columns=alike)
    rows = min(len(table), MOST_CELLS // max(len(varied.columns), 1))
    said = []
    if alike:
        values = "; ".join(f"{text(c)} {_cell(table[c].iloc[0]) or 'not a number'}" for c in alike)
        said.append(f"<p>The same in all rows: {values}.</p>")
    if rows < len(table):
        said.append(f"<p>The first {rows} of {len(table)} rows; <code>table.csv</code> has all.</p>")
    return "".join(said) + sortable(varied.head(rows))


def listed(rows: Sequence[Sequence[Any]]) -> str:
    """A table of which each row begins with what it is."""
    lines = [
        f'<tr><th scope="row" class="row">{text(name)}</th>' + "".join(f"<td{TEXT}>{text(v)}</td>" for v in values)
        for name, *values in rows
    ]
    body = "".join(f"{line}</tr>" for line in lines)
    return _boxed(f"<table><tbody>{body}</tbody></table>")


def _boxed(table: str) -> str:
    # What scrolls can be reached by the keyboard.
    return f'<div class="wide" tabindex="0">{table}</div>'


def _cell(value: Any) -> str:
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else f"{value:.4g}"
    return text(value)
