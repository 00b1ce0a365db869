"""Memory that is given back to the system costs a page fault for every 4 kB when it is asked for again."""

import ctypes
from functools import cache

TRIM_THRESHOLD, MMAP_THRESHOLD = -1, -3
"""Names of these in `mallopt` of the GNU C library."""

LARGEST = 2**25
"""Largest array that may be kept [bytes], the most that the library takes."""

KEPT = 2**28
"""How much of what is free is kept [bytes]."""


@cache
def keep_freed_memory() -> bool:
    """Let this process keep what its arrays free, for the next ones; returns whether the C library can.

    Blocks of trials make and free the same arrays again and again. With the library's own thresholds the system hands
    them out anew every time, and blocks of 500 trials of 33 looks take 1.9 times as long.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError, TypeError):
        return False
    mallopt.argtypes, mallopt.restype = [ctypes.c_int, ctypes.c_int], ctypes.c_int
    return bool(mallopt(MMAP_THRESHOLD, LARGEST)) and bool(mallopt(TRIM_THRESHOLD, KEPT))
