"""Run a study: blocks of trials, in parallel, into a store that any later run goes on with."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from joblib import delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError
from numpy.typing import NDArray

from studies import manifest, seeds
from studies.allocation import keep_freed_memory
from studies.blocks import Store
from studies.design import Point, Task, blocks, computed, methods, points, task
from studies.experiment import Experiment
from studies.lock import only_writer
from studies.measure import measure
from studies.memory import check_memory
from studies.method import Method
from studies.named import imported
from studies.parallel import BACKENDS, one_thread, parallel
from studies.stopping import standings
from studies.study import Study
from studies.table import columns_at

LOOSE = 512
"""Blocks of a point that may lie in files of their own before these are put together."""

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Share:
    """One of several machines' part of a study.

    Attributes
    ----------
    number, of
        Which part, from 1, of how many.

    Raises
    ------
    ValueError
        For a number that is not 1 to `of`.
    """

    number: int = 1
    of: int = 1

    def __post_init__(self) -> None:
        if not 1 <= self.number <= self.of:
            raise ValueError(f"shard is {self.number}/{self.of}; it must be K/N with K between 1 and N")

    def of_blocks(self, study: Study, point: Point, chosen: NDArray[np.intp]) -> NDArray[np.intp]:
        """The blocks that belong to it: every `of`-th, or all of every `of`-th point where a rule ends points."""
        places = point.number + 0 * chosen if study.trials.until else point.number * blocks(study) + chosen
        mine: NDArray[np.intp] = chosen[places % self.of == self.number - 1]
        return mine


@dataclass(frozen=True)
class Run:
    """How to run a study.

    Attributes
    ----------
    seed
        Root of all random numbers, 0 to 2^128 - 1.
    jobs
        Blocks at a time; as joblib counts them.
    backend
        One of joblib's, of `BACKENDS`.
    scheduler
        Address of a running Dask scheduler, for the backend "dask". Its workers must see the folder of the run.
    fail_fast
        Whether the first estimate that fails ends the run; otherwise it is counted.
    share
        Which part of the study.

    Raises
    ------
    ValueError
        For a value that cannot be.
    """

    seed: int = 2026
    jobs: int = -1
    backend: str = "loky"
    scheduler: str | None = None
    fail_fast: bool = False
    share: Share = Share()

    def __post_init__(self) -> None:
        if self.backend not in BACKENDS:
            raise ValueError(f"backend is {self.backend!r}; it must be one of {', '.join(BACKENDS)}")
        if (self.backend == "dask") != (self.scheduler is not None):
            raise ValueError(
                f"scheduler is {self.scheduler!r}; the backend dask needs one, such as tcp://host:8786, no other"
            )
        seeds.check(self.seed)
        if self.jobs == 0:
            raise ValueError("jobs is 0; it must be 1 or more, or -1 for one a processor")


def check(study: Study) -> list[Point]:
    """The design points of a study, each of which can be simulated and estimated; none of one that has no trials.

    Raises
    ------
    ValueError
        For a point, a window or an estimator that cannot be; names what was given and what is allowed.
    """
    for section in study.figures:
        if section.draw is not None:
            imported(section.draw, "draw")
    if study.answer is not None:
        imported(study.answer, "answer")
    if not study.simulates:
        if study.experiment is not None:
            imported(study.experiment.measure, "measure")
            return []
        for varied, makes, sonar in computed(study):
            assert not isinstance(makes, Experiment)
            study.check_columns([*varied, *makes.columns(sonar)])
        return []
    found = list(points(study))
    for point in found:
        made = methods(study, point)
        check_memory(study, point)
        if point.number == 0:
            for method in made:
                method.build(seeds.generator(0, point.echoes, 0, method.stream()))
            study.check_columns(columns_at(point))
    return found


def store_of(study: Study, seed: int, folder: Path) -> Store:
    """The block files of a study, as they are now.

    Parameters
    ----------
    study, seed
        What was run, and the root of its random numbers.
    folder
        That of the run.

    Returns
    -------
    Store
        Of what the folder holds of this design; empty where it holds none.
    """
    return Store(folder / "blocks", manifest.digest(manifest.design(study, seed)))


def run(study: Study, how: Run, folder: Path, progress: Progress = lambda done, total: None) -> None:
    """Simulate and estimate what a folder lacks of a study.

    Every block is stored as it is done. The numbers depend on the study, its estimators and the seed alone, but for the
    measured times: not on the backend, the jobs, the order of the blocks or on how often the run was interrupted. Time
    grows as the trials do, and falls as one over the jobs up to the cores; memory does not grow with the trials.

    Parameters
    ----------
    study
        What to run.
    how
        Which seed, on how many processes.
    folder
        Where to, and what to go on with.
    progress
        Called with the number of blocks done and in all, as far as is known.

    Raises
    ------
    ValueError
        For a folder of another design, for whatever the study finds wrong, and for the first failure where it shall end
        the run.
    OSError
        Where the folder cannot be written.
    """
    design = check(study)
    with only_writer(folder):
        manifest.begin(study, how.seed, folder)
        store_of(study, how.seed, folder).clean()
        while design and not _pass(study, how, design, folder, progress):
            pass


def _pass(study: Study, how: Run, design: Sequence[Point], folder: Path, progress: Progress) -> bool:
    """Complete what is lacking, as far as it is known; whether nothing was."""
    store = store_of(study, how.seed, folder)
    lacks = [_Lack.of(study, how.share, point, store) for point in design]
    total, first = sum(lack.total for lack in lacks), sum(lack.blocks.size for lack in lacks)
    left = first
    progress(total - left, total)
    try:
        for number in _completed(study, how, lacks, folder) if left else ():
            left -= 1
            progress(total - left, total)
            lacks[number].tidy(store)
    except TerminatedWorkerError:
        # A worker that is killed takes its pool along. What was stored stays; the rest is asked for again.
        if left == first:
            lack = next(lack for lack in lacks if lack.left)
            raise OSError(
                f"a worker was killed before any block was done, at point {lack.point.number} or after it; "
                f"the machine may lack memory, or an estimator end its process"
            ) from None
    return first == 0


@dataclass(eq=False)
class _Lack:
    """What a share of a study lacks at a point: blocks, and for each estimator whether it lacks each of them."""

    point: Point
    total: int
    blocks: NDArray[np.intp]
    methods: list[tuple[Method, NDArray[np.bool_]]]
    left: int

    @classmethod
    def of(cls, study: Study, share: Share, point: Point, store: Store) -> "_Lack":
        chosen = methods(study, point)
        found = standings(study, point, chosen, store.read(point))
        whole = share.of_blocks(study, point, np.arange(max(standing.target for standing in found.values())))
        lacking = [(method, found[method.labels].lacks(whole)) for method in chosen]
        any_lacks = np.any([lacks for _, lacks in lacking], axis=0)
        missing = whole[any_lacks]
        return cls(point, whole.size, missing, [(m, lacks[any_lacks]) for m, lacks in lacking], missing.size)

    def tasks(self, study: Study) -> Iterator[tuple[Task, list[Method]]]:
        for place, block in enumerate(self.blocks.tolist()):
            yield task(study, self.point, block), [method for method, lacks in self.methods if lacks[place]]

    def tidy(self, store: Store) -> None:
        """Put files together when the point is finished, and now and then before."""
        self.left -= 1
        if self.left == 0:
            store.compact(self.point)
        elif self.left % LOOSE == 0:
            store.compact(self.point, shorter_than=LOOSE)


def _completed(study: Study, how: Run, lacks: Sequence[_Lack], folder: Path) -> Iterator[int]:
    """Complete the blocks that are lacking; yields the number of the point of each as it is stored."""
    store = store_of(study, how.seed, folder)
    with parallel(how.backend, how.jobs, how.scheduler) as workers:
        yield from workers(
            delayed(_complete_block)(store, lack.point.number, task, methods, study.trials.block, how)
            for lack in lacks
            for task, methods in lack.tasks(study)
        )


def _complete_block(
    store: Store, number: int, task: Task, lacking: Sequence[Method], block_trials: int, how: Run
) -> int:
    """Measure what a block lacks, and store it with what it has."""
    keep_freed_memory()
    with one_thread():
        block = measure(task, lacking, block_trials, how.seed)
    failures = [measurement for measurement in block.measurements if measurement.failed]
    if how.fail_fast and failures:
        first, named = failures[0].failed[0], " ".join(failures[0].labels)
        varied = dict(task.point.varied)
        raise ValueError(f"{named} failed at {varied}, block {task.block}, trial {first.trial}: {first.error}")
    store.write(task, block)
    return number
