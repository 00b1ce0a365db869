"""Interferogram and energies of a window of one size, in one compiled pass over both images.

A line of sums over rows moves down the image, from which the row that leaves the window is taken off again; sums over
samples move along it likewise. All are of double precision. What rounding a bright pixel leaves behind when it has
gone is a few parts in 1e16 of it, and stays no longer than to the next fresh start.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled, compiled_fusing

WIDTH = 2048
"""Samples along which sums move from one fresh start to the next, and that the line holds."""

EPSILON = 2.0**-51
"""Rounding of a step, in parts of the brightest of some windows: no other has more than twice their energy."""

Array = NDArray[Any]
Scales = tuple[float | None, float | None, float | None]


@compiled
def interfere(
    primary: Array,
    secondary: Array,
    scales: Scales,
    block: tuple[int, int],
    sizes: tuple[int, int],
    circular: bool,
    product: Array,
    energy: Array | None,
    coherence: Array | None,
) -> None:
    """Windowed sums of `conj(p) s`, `|p|^2` and `|s|^2` of the rows from the first of a block to before its last.

    Complex numbers are pairs of real ones. The scales are those of the primary, the secondary and the product given;
    None stands for 1, without the time of a multiplication.
    `energy` takes the root of the product of both energies, `coherence` the magnitude of the product over it. A single
    column takes the sums of the whole period. Where an energy lies within what rounding may have left of the brightest
    window before, the window counts as empty.
    """
    rows, samples = primary.shape[0], primary.shape[1] // 2
    (first, last), (height, length) = block, sizes
    line, sums = np.empty((4, WIDTH + length)), np.empty((4, WIDTH))
    nothing = np.zeros(2 * (WIDTH + length), primary.dtype)
    for begin in range(0, product.shape[1] // 2, WIDTH):
        count = min(WIDTH, product.shape[1] // 2 - begin)
        parts = _parts(begin - length // 2, count + length, samples, circular)
        steps = (length * (last - first + height) if height > 1 else 0) + (count if length > 1 else 0)
        highest = highest_other = 0.0
        line[:], sums[:] = 0, 0
        for r in range(first + 1 - height, last):
            new, old = r - height // 2 + height - 1, r - height // 2 - 1
            if height == 1:
                line[:] = 0
            # What lies before the block's first window was never taken in.
            leaves = height > 1 and old >= max(first - height // 2, 0)
            comes = 0 <= new < rows
            for k in range(len(parts)):
                at, x, end = parts[k, 0], 2 * parts[k, 1], 2 * (parts[k, 1] + parts[k, 2])
                _move_down(
                    primary[old, x:end] if leaves else nothing[: end - x],
                    secondary[old, x:end] if leaves else nothing[: end - x],
                    primary[new, x:end] if comes else nothing[: end - x],
                    secondary[new, x:end] if comes else nothing[: end - x],
                    scales[0],
                    scales[1],
                    line,
                    at,
                )
            if r >= first:
                _move_along(line, length, count, sums)
                highest = max(highest, _highest(sums[2], length, count))
                highest_other = max(highest_other, _highest(sums[3], length, count))
                brightest = highest, highest_other
                _give(sums, brightest, EPSILON * steps, scales[2], r, begin, count, product, energy, coherence)


@compiled
def _parts(start: int, count: int, samples: int, circular: bool) -> Array:
    """Which samples of the record fill the line from `start` on: place in the line, first sample, how many."""
    parts = np.empty((2 + count // samples + 1, 3), np.int64)
    number = at = 0
    while at < count:
        x = start + at
        if circular:
            x %= samples
        elif x < 0:
            at -= x
            continue
        elif x >= samples:
            break
        parts[number] = at, x, min(count - at, samples - x)
        at += parts[number, 2]
        number += 1
    return parts[:number]


@compiled_fusing
def _move_down(
    p: Array, s: Array, new_p: Array, new_s: Array, f: float | None, g: float | None, line: Array, at: int
) -> None:
    a, b, c, d = line[0, at:], line[1, at:], line[2, at:], line[3, at:]
    for i in range(p.size // 2):
        px, py, sx, sy = _by(p[2 * i], f), _by(p[2 * i + 1], f), _by(s[2 * i], g), _by(s[2 * i + 1], g)
        qx, qy, tx, ty = _by(new_p[2 * i], f), _by(new_p[2 * i + 1], f), _by(new_s[2 * i], g), _by(new_s[2 * i + 1], g)
        a[i] += (qx * tx + qy * ty) - (px * sx + py * sy)
        b[i] += (qx * ty - qy * tx) - (px * sy - py * sx)
        c[i] += (qx * qx + qy * qy) - (px * px + py * py)
        d[i] += (tx * tx + ty * ty) - (sx * sx + sy * sy)


@compiled
def _by(number: float, scale: float | None) -> float:
    return np.float64(number) if scale is None else number * scale


@compiled
def _move_along(line: Array, length: int, count: int, sums: Array) -> None:
    if length == 1:
        sums[:, :count] = line[:, :count]
        return
    a = b = c = d = 0.0
    for i in range(length):
        a, b, c, d = a + line[0, i], b + line[1, i], c + line[2, i], d + line[3, i]
    w, x, y, z = sums[0], sums[1], sums[2], sums[3]
    old_w, old_x, old_y, old_z = line[0], line[1], line[2], line[3]
    new_w, new_x, new_y, new_z = line[0, length:], line[1, length:], line[2, length:], line[3, length:]
    for i in range(count):
        w[i], x[i], y[i], z[i] = a, b, c, d
        a += new_w[i] - old_w[i]
        b += new_x[i] - old_x[i]
        c += new_y[i] - old_y[i]
        d += new_z[i] - old_z[i]


@compiled
def _highest(energies: Array, length: int, count: int) -> float:
    """Of windows side by side and of the last; any other lies within two of them, or in the last and one of them."""
    highest: float = energies[count - 1]
    for i in range(0, count, length):
        highest = max(highest, energies[i])
    return highest


@compiled
def _give(
    sums: Array,
    brightest: tuple[float, float],
    left: float,
    scale: float | None,
    r: int,
    begin: int,
    count: int,
    product: Array,
    energy: Array | None,
    coherence: Array | None,
) -> None:
    """Write a row; `left` is what rounding may have left of the brightest energies, in parts of them."""
    w, x, y, z = sums[0], sums[1], sums[2], sums[3]
    # Of windows so dark beside others that no energy squared holds them, nothing is known.
    faint = brightest[0] * brightest[1] < 1e-300
    floor, floor_other = (np.inf, np.inf) if faint else (left * brightest[0], left * brightest[1])
    out = product[r, 2 * begin : 2 * (begin + count)]
    if energy is not None:
        root = energy[r, begin : begin + count]
        for i in range(count):
            here = 1.0 if y[i] > floor and z[i] > floor_other else 0.0
            out[2 * i], out[2 * i + 1] = _by(w[i] * here, scale), _by(x[i] * here, scale)
            root[i] = _by(np.sqrt(max(y[i], 0.0) * max(z[i], 0.0)) * here, scale)
    if coherence is not None:
        share, kind = coherence[r, begin : begin + count], coherence.dtype.type
        # On a scale that single precision holds, which divides in half the time.
        unit = 1 / max(brightest[0] * brightest[1], 1e-300)
        for i in range(count):
            here = (y[i] > floor) & (z[i] > floor_other)
            a, b = (w[i], x[i]) if here else (0.0, 0.0)
            out[2 * i], out[2 * i + 1] = _by(a, scale), _by(b, scale)
            squared = kind((a * a + b * b) * unit) / kind(y[i] * z[i] * unit if here else 1.0)
            share[i] = np.sqrt(min(squared, kind(1.0)))
