"""Window sums of rows of samples and over rows, compiled: of one length, or of lengths that vary over time.

One length is put together from the tail of one block and the head of the next (van Herk 1992), so that nothing is
subtracted. Lengths that vary are differences of running sums, begun anew in every block, that carry their rounding
errors along (Neumaier 1974): a sum errs by the rounding unit of itself, and by its square of what its block holds.
Blocks are as long as the longest window, so that a window touches two at the most, and the cost is that of any length.

A row is held with what lies before and after the record around it: index `i` stands for time `i - length // 2`, and
the window of a time begins at the index of that time or later, and ends within `length` of it.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled

COLUMNS = 64
"""Samples whose running sums over rows are held at a time, so that they stay in the cache."""

WIDTH = 512
"""Numbers of a row that are summed over rows at a time, likewise."""

NOTHING, PERIOD, MORE = 0, 1, 2
"""What lies beyond the samples of a row: nothing, the same again, or more columns of the arrays."""

Numbers = NDArray[Any]
Sizes = NDArray[np.intp]


@compiled
def sum_in_time(
    first: Numbers, second: Numbers | None, begins: tuple[int, int], samples: int, length: int, beyond: int, out: Any
) -> None:
    """Sums over `length` samples of `first`, or of `conj(first) second`.

    Rows hold `samples` from where the first and the second begin. One column of `out` takes the sum of a whole period.
    """
    row, heads = np.zeros(samples + length, out.dtype), np.empty(length, out.dtype)
    for r in range(first.shape[0]):
        _fill(row, first, second, begins, samples, r, length, beyond)
        _add_tails_and_heads(row, length, heads, out[r])


@compiled
def varying_sum_in_time(
    first: Numbers,
    second: Numbers | None,
    begins: tuple[int, int],
    samples: int,
    sizes: Sizes,
    beyond: int,
    out: Any,
) -> None:
    """Sums as `sum_in_time`, over a number of samples of its own for every time."""
    length = sizes.max()
    row = np.zeros(samples + length, out.dtype)
    places = row.size + row.size // length + 2
    high, low = np.empty(places, out.dtype), np.empty(places, out.dtype)
    for r in range(first.shape[0]):
        _fill(row, first, second, begins, samples, r, length, beyond)
        _run_sums(row, length, high, low)
        for t in range(samples):
            out[r, t] = _window(high, low, t, sizes[t], length)


@compiled
def sum_over_rows(array: Numbers, length: int, out: Numbers) -> None:
    """Sums over `length` rows, of which none lie beyond the array."""
    rows, samples = array.shape
    cells, head = np.empty((length, WIDTH), array.dtype), np.empty(WIDTH, array.dtype)
    for begin in range(0, samples, WIDTH):
        width = min(WIDTH, samples - begin)
        cells[:] = 0
        for block in range(-1, (rows - 1) // length + 1):
            head[:] = 0
            for k in range(length):
                r, new = block * length + k, (block + 1) * length - length // 2 + k
                if 0 <= r < rows:
                    _add(cells[k], head, out[r, begin : begin + width])
                if 0 <= new < rows:
                    _take_in(array[new, begin : begin + width], cells[k], head)
                else:
                    cells[k] = 0
            for k in range(length - 2, -1, -1):
                _add(cells[k], cells[k + 1], cells[k])


@compiled
def varying_sum_over_rows(array: Numbers, sizes: Sizes, out: Numbers) -> None:
    """Sums as `sum_over_rows`, over a number of rows of its own for every column."""
    rows, samples = array.shape
    length = sizes.max()
    before = length // 2
    columns = np.zeros((COLUMNS, rows + length), out.dtype)
    places = columns.shape[1] + columns.shape[1] // length + 2
    high, low = np.empty(places, out.dtype), np.empty(places, out.dtype)
    for begin in range(0, samples, COLUMNS):
        width = min(COLUMNS, samples - begin)
        for r in range(rows):
            for c in range(width):
                columns[c, before + r] = array[r, begin + c]
        for c in range(width):
            _run_sums(columns[c], length, high, low)
            for r in range(rows):
                columns[c, before + r] = _window(high, low, r, sizes[begin + c], length)
        for r in range(rows):
            for c in range(width):
                out[r, begin + c] = columns[c, before + r]


@compiled
def _fill(
    row: Numbers,
    first: Numbers,
    second: Numbers | None,
    begins: tuple[int, int],
    samples: int,
    r: int,
    length: int,
    beyond: int,
) -> None:
    before = length // 2
    # The whole row, or the samples alone.
    aside, count = (before, samples + length) if beyond == MORE else (0, samples)
    inner = row[before - aside : before - aside + count]
    a = first[r, begins[0] - aside : begins[0] - aside + count]
    if second is None:
        for i in range(count):
            inner[i] = a[i]
    else:
        b = second[r, begins[1] - aside : begins[1] - aside + count]
        for i in range(count):
            inner[i] = np.conj(np.complex128(a[i])) * np.complex128(b[i])
    if beyond == PERIOD:
        row[:before] = inner[samples - before :]
        row[before + samples :] = inner[: length - before]


@compiled
def _add_tails_and_heads(row: Numbers, length: int, heads: Numbers, out: Numbers) -> None:
    for begin in range(0, out.size, length):
        count = min(length, out.size - begin)
        tail = head = row[0] * 0
        for k in range(length - 1, count - 1, -1):
            tail += row[begin + k]
        # Two sums at a time, that do not wait for each other.
        for k in range(count):
            here = begin + count - 1 - k
            tail += row[here]
            out[here] = tail
            heads[k] = head
            head += row[begin + length + k]
        for k in range(count):
            out[begin + k] += heads[k]


@compiled
def _add(one: Numbers, other: Numbers, out: Numbers) -> None:
    for i in range(out.size):
        out[i] = one[i] + other[i]


@compiled
def _take_in(new: Numbers, cells: Numbers, head: Numbers) -> None:
    for i in range(new.size):
        cells[i] = new[i]
        head[i] += new[i]


@compiled
def _run_sums(row: Numbers, length: int, high: Numbers, low: Numbers) -> None:
    """Sums of what lies before each index in its block of `length`, and before the block's end; `low` is to be added.

    Block `b` takes the places `b (length + 1)` to `b (length + 1) + length`.
    """
    place = 0
    for begin in range(0, row.size, length):
        total = rest = row[0] * 0
        for i in range(begin, min(begin + length, row.size)):
            high[place], low[place] = total, rest
            place += 1
            more = total + row[i]
            part = more - total
            rest += (total - (more - part)) + (row[i] - part)
            total = more
        high[place], low[place] = total, rest
        place += 1


@compiled
def _window(high: Numbers, low: Numbers, t: int, size: int, length: int) -> Any:
    begin = t + length // 2 - size // 2
    block, offset = begin // length, begin % length
    first = block * (length + 1) + offset
    if offset + size <= length:
        return _between(high, low, first, first + size)
    end = block * (length + 1) + length
    rest = end + 1 + offset + size - length
    return _between(high, low, first, end) + (high[rest] + low[rest])


@compiled
def _between(high: Numbers, low: Numbers, first: int, last: int) -> Any:
    total = high[last] - high[first]
    part = total - high[last]
    lost = (high[last] - (total - part)) - (high[first] + part)
    return total + (lost + (low[last] - low[first]))
