"""What the study of wrap errors says."""

import pandas as pd


def answer(table: pd.DataFrame) -> str:
    """How often the prediction holds, and how near the bound the estimators come."""
    said = []
    for name, rows in table.groupby("estimator", sort=False):
        within = rows.predicted_wrap_rate.between(rows.wrap_rate_low, rows.wrap_rate_high)
        known = rows[rows.wrap_rate < 0.5]
        ratio = (known.delay_std_in_wrap / known.crlb).mean()
        said.append(
            f"{name}: the predicted wrap-error rate lies within the 95 % interval at {within.sum()} of {len(rows)} "
            f"points, and the in-wrap spread is {ratio:.3f} times the bound on average where most wraps are right"
        )
    return ". ".join(said) + "."
