"""Compilation of the few loops that NumPy would make in many passes."""

from collections.abc import Callable
from typing import TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """The function as machine code that lets other threads run, kept on disk where that can be written."""
    machine_code: Function = numba.njit(cache=True, nogil=True)(function)
    return machine_code
