"""The answer of a study that has no words of its own for it."""

import pandas as pd

MAIN = {
    "wrap_rate": ("the wrap-error rate", ""),
    "std_over_crlb": ("the in-wrap spread", " times the Cramér-Rao bound"),
    "rmse": ("the RMSE", " s"),
}
"""Columns that are told: their names and units."""


def plain_answer(table: pd.DataFrame) -> str:
    """From what to what the main results of each estimator go; empty for a table without estimators."""
    if "estimator" not in table or not any(column in table for column in MAIN):
        return ""
    said = []
    for name, rows in table.groupby("estimator", sort=False):
        told = {c: words for c, words in MAIN.items() if c in rows and rows[c].notna().any()}
        ranges = [f"{what} is {_range(rows[column])}{unit}" for column, (what, unit) in told.items()]
        if ranges:
            counted = "1 row" if len(rows) == 1 else f"{len(rows)} rows"
            said.append(f"{name}, {counted}: {', '.join(ranges)}")
    return f"{'. '.join(said)}." if said else ""


def _range(values: "pd.Series[float]") -> str:
    low, high = f"{values.min():.3g}", f"{values.max():.3g}"
    return low if low == high else f"{low} to {high}"
