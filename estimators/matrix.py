"""The definition of all methods: masks of the frequency-frequency matrix of one pixel, in `O(N^2)` a pixel; for checks.

Nothing here shares code with the methods that it defines; `docs/family.md` says what follows from it.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.band import Complex, Real

Lines = NDArray[np.int64]
Mask = Callable[[Lines, Lines, int], NDArray[Any]]
"""From the harmonics `n` and `m` and the number of samples to `Phi_nm`."""


def lines(series: Complex) -> tuple[Lines, Complex]:
    """Harmonics and Fourier coefficients of a periodic series; half of the Nyquist bin at either end of the band."""
    n = len(series)
    harmonics = np.arange(-(n // 2), n // 2 + 1)
    coefficients = np.exp(-2j * np.pi * np.outer(harmonics, np.arange(n)) / n) @ series / n
    if n % 2 == 0:
        coefficients[[0, -1]] /= 2
    return harmonics, coefficients


def family(
    primary: Complex,
    secondary: Complex,
    mask: Mask,
    delay: ArrayLike = 0.0,
    times: Sequence[int] | None = None,
) -> Complex:
    """`sum_nm Phi_nm Q_n* R_m exp(i (w_n + w_m) delay / 2)` at every time.

    Paper A, equations 7 to 18, with the factor 2 pi and the 1/N that it leaves out, frequencies around zero, so that
    the series are baseband, and all anti-diagonals, half-bin ones too. The model's phase is conjugate to that of the
    interferogram, which turns as `exp(-i w delay)`.

    Parameters
    ----------
    primary, secondary
        Periodic series, shape (samples,).
    mask
        Gives `Phi_nm`.
    delay
        One or more [samples].
    times
        Samples at which it is computed; all if None.

    Returns
    -------
    array
        Shape (time,), or (delay, time) for more than one delay.
    """
    samples = len(primary)
    harmonics, spectrum_p = lines(primary)
    _, spectrum_s = lines(secondary)
    n, m = harmonics[:, None], harmonics[None, :]
    phi = mask(n, m, samples)
    # Sums over anti-diagonals, on which the exponential is the same.
    diagonal = (n + m - 2 * harmonics[0]).ravel()
    slopes = np.exp(1j * np.pi * np.multiply.outer(delay, np.arange(2 * harmonics[0], -2 * harmonics[0] + 1)) / samples)
    found = []
    for t in range(samples) if times is None else times:
        turn = np.exp(2j * np.pi * harmonics * t / samples)
        matrix = (phi * np.outer((spectrum_p * turn).conj(), spectrum_s * turn)).ravel()
        sums = np.bincount(diagonal, matrix.real) + 1j * np.bincount(diagonal, matrix.imag)
        found.append(slopes @ sums)
    return np.stack(found, axis=-1)


def everything(n: Lines, m: Lines, samples: int) -> Real:
    """The whole matrix: one pixel at the full resolution of the band."""
    return np.ones(np.broadcast_shapes(n.shape, m.shape))


def window(length: int) -> Mask:
    """A window in time of `length` samples: the mask depends on `m - n` alone."""

    def mask(n: Lines, m: Lines, samples: int) -> Complex:
        offsets = np.arange(length) - length // 2
        phi: Complex = np.exp(2j * np.pi * (m - n)[..., None] * offsets / samples).sum(axis=-1)
        return phi

    return mask


def band(centre: float, width: float) -> Mask:
    """A block on the diagonal: a sub-band, in Fourier bins, of which the outermost may belong to it in part."""

    def amplitude(k: Lines, samples: int) -> Real:
        share = np.clip(width / 2 - np.abs(k - centre) + 0.5, 0.0, 1.0)
        # The Nyquist bin lies at both ends of the band, and is left out.
        root: Real = np.sqrt(np.where(2 * np.abs(k) == samples, 0.0, share))
        return root

    def mask(n: Lines, m: Lines, samples: int) -> Real:
        return amplitude(n, samples) * amplitude(m, samples)

    return mask
