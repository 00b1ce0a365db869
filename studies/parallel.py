"""Where blocks are computed: in this process, in threads or processes, or on the workers of a Dask scheduler."""

import logging
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import lru_cache

from joblib import Parallel, parallel_config
from threadpoolctl import ThreadpoolController

BACKENDS = ("loky", "threading", "sequential", "dask")


@contextmanager
def parallel(backend: str, jobs: int, scheduler: str | None) -> Iterator[Parallel]:
    """Workers that give results as they are done, in any order.

    Parameters
    ----------
    backend
        One of `BACKENDS`.
    jobs
        Blocks at a time; of no meaning to Dask, which asks its scheduler.
    scheduler
        Address of a running Dask scheduler, for the backend "dask".

    Raises
    ------
    ValueError
        Where Dask is asked for and not installed.
    OSError
        Where its scheduler does not answer, or goes away.
    """
    if backend == "dask":
        with _dask(scheduler), parallel_config(backend="dask"):
            yield Parallel(n_jobs=-1, return_as="generator_unordered")
    else:
        threads = {"inner_max_num_threads": 1} if backend == "loky" else {}
        yield Parallel(n_jobs=jobs, backend=backend, return_as="generator_unordered", **threads)


@contextmanager
def _dask(scheduler: str | None) -> Iterator[None]:
    try:
        from distributed import CancelledError, Client, KilledWorker
    except ImportError:
        raise ValueError("backend is dask; it must be installed: pip install 'twinecho[dask]'") from None
    # What it says of itself is said below, in one line.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        with Client(scheduler, timeout="5s", set_as_default=True):
            yield
    except KilledWorker as error:
        raise OSError(f"workers of {scheduler} die of a block: {error}; what was done is stored") from None
    except (OSError, TimeoutError, CancelledError) as error:
        # An error of the system has a number, one of the connection none.
        if getattr(error, "errno", None) is not None:
            raise
        said = str(error) or type(error).__name__
        raise OSError(f"the Dask scheduler {scheduler} does not answer: {said}; what was done is stored") from None


@lru_cache(maxsize=1)
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()


def one_thread() -> AbstractContextManager[object]:
    """One thread for the linear algebra of this process, so that blocks do not crowd each other out."""
    limited: AbstractContextManager[object] = _libraries().limit(limits=1)
    return limited
