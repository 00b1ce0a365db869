"""Functions compiled by numba when first called; kept on disk where that can be written to."""

from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile a function to machine code that releases the interpreter's lock.

    Rounding is that of NumPy: nothing is reordered, and a division by zero gives an infinity, not an error.
    """
    return _compiled(function, set())


def compiled_fusing(function: Function) -> Function:
    """Compile as `compiled`, but let a product be added without being rounded first."""
    return _compiled(function, {"contract"})


def _compiled(function: Function, fastmath: set[str]) -> Function:
    dispatcher = numba.njit(nogil=True, error_model="numpy", fastmath=fastmath)(function)
    # Where no folder can be written to, it is compiled anew in every process.
    with suppress(RuntimeError):
        dispatcher.enable_caching()
    return cast(Function, dispatcher)
