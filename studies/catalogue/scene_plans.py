"""What the shortcuts of the simulation save, in words."""

import pandas as pd

from studies.shortcut import STATISTICS


def answer(table: pd.DataFrame) -> str:
    """How each scene is simulated, how much cheaper that is, and how far it is off in parts of what is allowed."""
    said = []
    for scene, rows in table.groupby("scene", sort=False):
        first = rows.iloc[0]
        off = [
            (abs(row[f"{name}_difference"]) / row[f"{name}_tolerance"], row[f"{name}_se"] / row[f"{name}_tolerance"])
            for _, row in rows.iterrows()
            for name in STATISTICS
        ]
        part, error = max(off)
        said.append(
            f"{scene}: {first.delays}, {first.ratio:.1f} times cheaper, off by {part:.2g} (standard error {error:.2g})"
        )
    return f"{'; '.join(said)}, all at the most and in parts of what the plan allows."
