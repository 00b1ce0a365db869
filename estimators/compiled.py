"""Functions compiled by numba when first called; kept on disk where that can be written to."""

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """Compile a function to machine code that releases the interpreter's lock.

    Rounding is that of NumPy: nothing is reordered, and a division by zero gives an infinity, not an error.
    """
    return cast(Function, numba.njit(cache=True, nogil=True, error_model="numpy")(function))
