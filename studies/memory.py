"""Whether a block of a scene fits in memory, found out before it runs."""

import os
from pathlib import Path

from sim.costs import costs
from studies.design import Point
from studies.study import Study
from studies.swath import Swath

LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Where Linux says what a container may take."""


def memory() -> float:
    """Bytes that this machine, or the container that this process runs in, can hold; inf where it does not say."""
    found = [Path(limit).read_text().strip() for limit in LIMITS if Path(limit).is_file()]
    try:
        installed = float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        installed = float("inf")
    return min([installed, *(float(limit) for limit in found if limit.isdigit())])


def check_memory(study: Study, point: Point) -> None:
    """ValueError where a block of a scene takes more memory than there is; it says how much, and what would fit."""
    if not isinstance(point.world, Swath):
        return
    trials = min(study.trials.block, study.trials.count)
    rows = trials + 2 * (point.world.overlap or 0)
    # The size does not depend on what the rows hold, so that none is looked at.
    alone = point.world.required(point.sonar, 1)
    cost = costs(point.world.scene(), point.sonar, alone, rows, corners=0)
    needed, most = sum(held for _, held in cost.values()), memory()
    if needed > most:
        raise ValueError(
            f"{study.name}: a block of {rows} rows of {alone.grid.samples} samples takes {needed / 1e9:.3g} GB; "
            f"it must be below the {most / 1e9:.3g} GB of memory here: fewer trials.block or a shorter scene"
        )
