"""Run a study: blocks of trials, in parallel, into a store that any later run goes on with."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from joblib import delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError

from studies import manifest, seeds
from studies.blocks import Store, Task
from studies.parallel import BACKENDS, parallel
from studies.study import Block, Study


@dataclass(frozen=True)
class Run:
    """How to run a study.

    Attributes
    ----------
    methods
        Names of the estimators to compare; all of the study's where empty.
    seed
        Root of all random numbers.
    jobs
        Blocks at a time; as joblib counts them.
    backend
        One of joblib's, of `BACKENDS`.
    scheduler
        Address of a running Dask scheduler, for the backend "dask". Its workers must see the folder of the run.
    fail_fast
        Whether the first estimate that fails ends the run; otherwise it is counted.
    """

    methods: tuple[str, ...] = ()
    seed: int = 2026
    jobs: int = -1
    backend: str = "loky"
    scheduler: str | None = None
    fail_fast: bool = False


def check(study: Study, how: Run) -> tuple[str, ...]:
    """Names of the estimators that a run compares; ValueError for an unknown estimator or backend, or a bad seed."""
    known = tuple(study.methods())
    for name in how.methods:
        if name not in known:
            raise ValueError(f"estimator is {name!r}; of {study.name} it must be one of {', '.join(known)}")
    if how.backend not in BACKENDS:
        raise ValueError(f"backend is {how.backend!r}; it must be one of {', '.join(BACKENDS)}")
    if (how.backend == "dask") != (how.scheduler is not None):
        raise ValueError(
            f"scheduler is {how.scheduler!r}; the backend dask needs one, such as tcp://host:8786, no other"
        )
    seeds.check(how.seed)
    if how.jobs == 0:
        raise ValueError("jobs is 0; it must be 1 or more, or -1 for one a processor")
    return how.methods or known


def tasks(study: Study) -> list[Task]:
    """All blocks of a study, those of one point after each other."""
    starts = range(0, study.trials, study.block_trials)
    return [
        Task(point, number, min(study.block_trials, study.trials - start))
        for point in study.points()
        for number, start in enumerate(starts)
    ]


def store_of(study: Study, seed: int, folder: Path) -> Store:
    """The block files of a study with a seed below a folder."""
    return Store(folder / "blocks", manifest.digest(manifest.design(study, seed)))


def missing(store: Store, task: Task, methods: Sequence[str]) -> list[str]:
    """Estimators that a stored block lacks."""
    there = {measurement.labels["estimator"] for measurement in store.read(task)}
    return [name for name in methods if name not in there]


def measure(study: Study, task: Task, methods: Sequence[str], seed: int) -> Block:
    """Simulate one block and apply estimators to it; always the same numbers."""
    return study.measure(task.point, methods, task.trials, seeds.generator(seed, task.point, task.block))


def run(study: Study, how: Run, folder: Path, progress: Callable[[int, int], None] = lambda done, total: None) -> None:
    """Simulate and estimate what a folder lacks of a study.

    Every block is stored as it is done. The numbers depend on the study, its estimators and the seed alone, but for the
    measured times: not on the backend, the jobs, the order of the blocks or on how often the run was interrupted.

    Parameters
    ----------
    study
        What to run.
    how
        Which estimators, which seed, on how many processes.
    folder
        Where to, and what to go on with.
    progress
        Called with the number of blocks done and in all.

    Raises
    ------
    ValueError
        For an unknown estimator or backend, for a folder of another design, for whatever the study finds wrong, and
        for the first failure where it shall end the run.
    OSError
        Where the folder cannot be written.
    """
    methods = check(study, how)
    manifest.begin(study, how.seed, methods, folder)
    store, wanted = store_of(study, how.seed, folder), tasks(study)
    lacking = [(task, names) for task in wanted if (names := missing(store, task, methods))]
    while lacking:
        progress(len(wanted) - len(lacking), len(wanted))
        try:
            for done, _ in enumerate(_complete(study, how, store, lacking), len(wanted) - len(lacking) + 1):
                progress(done, len(wanted))
        except TerminatedWorkerError:
            # A worker that is killed takes its pool along. What was stored stays; the rest is asked for again.
            still = [(task, names) for task, _ in lacking if (names := missing(store, task, methods))]
            if len(still) == len(lacking):
                raise OSError("a worker was killed before any block was done; the machine may lack memory") from None
            lacking = still
        else:
            break
    progress(len(wanted), len(wanted))


def _complete(study: Study, how: Run, store: Store, lacking: Sequence[tuple[Task, list[str]]]) -> Iterator[None]:
    """Complete the blocks that lack something; yields as each is stored."""
    with parallel(how.backend, how.jobs, how.scheduler) as workers:
        yield from workers(delayed(_complete_block)(study, store, task, names, how) for task, names in lacking)


def _complete_block(study: Study, store: Store, task: Task, names: Sequence[str], how: Run) -> None:
    """Measure what a block lacks, and store it with what it has, in the study's order of estimators."""
    block = measure(study, task, names, how.seed)
    failures = [measurement for measurement in block.measurements if measurement.failure]
    if how.fail_fast and failures:
        named = " ".join(failures[0].labels.values())
        raise ValueError(f"{named} failed at {dict(task.point)}, block {task.block}, {failures[0].failure}")
    order = list(study.methods())
    together = [*store.read(task), *block.measurements]
    together.sort(key=lambda measurement: order.index(measurement.labels["estimator"]))
    traces = {**store.read_traces(task), **block.traces} if task.block == 0 else {}
    store.write(task, replace(block, measurements=together, traces=traces))
