"""Progress of what takes long, as a bar on a terminal and as lines elsewhere."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

Show = Callable[[int, int], None]
"""Called with how many are done, and of how many."""


@contextmanager
def progress(name: str, things: str) -> Iterator[Show]:
    """Show how many things of a name are done, on standard error."""
    terminal = Console(stderr=True)
    if not terminal.is_terminal:
        yield _Lines(name, things)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=terminal) as bar:
        task = bar.add_task(name)
        yield lambda done, total: bar.update(task, completed=done, total=total)


class _Lines:
    """Progress as a plain line for each tenth of all or 20 s, with the time that the rest will take."""

    def __init__(self, name: str, things: str) -> None:
        self.name, self.things, self.start = name, things, perf_counter()
        self.first, self.shown = -1, (-1, -1, -1)

    def __call__(self, done: int, total: int) -> None:
        seconds = perf_counter() - self.start
        reached = 10 * done // max(total, 1), total, int(seconds // 20)
        self.first = done if self.first < 0 else self.first
        if reached == self.shown:
            return
        self.shown = reached
        left = f", {seconds * (total - done) / (done - self.first):.0f} s left" if done > self.first else ""
        print(f"{self.name}: {done} of {total} {self.things} in {seconds:.0f} s{left}", file=sys.stderr, flush=True)
