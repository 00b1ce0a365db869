"""What the shortcuts of the simulation save, in words."""

import pandas as pd


def answer(table: pd.DataFrame) -> str:
    """How each scene is simulated, how much cheaper that is, and how far it is off in parts of what is allowed."""
    said = []
    for name, rows in table.groupby("scene", sort=False):
        first = rows.iloc[0]
        off = {
            what: (rows[f"{what}_difference"].abs() / rows[f"{what}_tolerance"]).max()
            for what in ("coherence", "delay", "level")
        }
        worst = max(off, key=lambda what: off[what])
        said.append(
            f"{name}: {first.delays}, {first.ratio:.1f} times cheaper, off by {off[worst]:.2g} of what is "
            f"allowed at the most ({worst})"
        )
    return f"{'; '.join(said)}."
