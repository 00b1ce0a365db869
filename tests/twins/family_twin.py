"""Every method as a mask of one matrix, term by term and pixel by pixel."""

import numpy as np


def lines(series):
    """Harmonics and Fourier coefficients of a periodic series; half of the Nyquist bin at either end of the band."""
    n = len(series)
    harmonics = np.arange(-(n // 2), n // 2 + 1)
    coefficients = np.exp(-2j * np.pi * np.outer(harmonics, np.arange(n)) / n) @ series / n
    if n % 2 == 0:
        coefficients[[0, -1]] /= 2
    return harmonics, coefficients


def family(primary, secondary, mask, delay=0.0):
    """`sum_nm Phi_nm Q_n* R_m exp(i (w_n + w_m) delay / 2)` at every time; `delay` in samples.

    Paper A, equations 7 to 18, with the factor 2 pi and the 1/N that it leaves out, frequencies around zero, so that
    the series are baseband, and all anti-diagonals, half-bin ones too. The model's phase is conjugate to that of the
    interferogram, which turns as `exp(-i w delay)`. `mask(n, m, samples)` gives `Phi_nm`.
    """
    samples = len(primary)
    harmonics, spectrum_p = lines(primary)
    _, spectrum_s = lines(secondary)
    n, m = harmonics[:, None], harmonics[None, :]
    phi = mask(n, m, samples)
    found = np.zeros(samples, dtype=complex)
    for t in range(samples):
        turn = np.exp(2j * np.pi * harmonics * t / samples)
        matrix = phi * np.outer((spectrum_p * turn).conj(), spectrum_s * turn)
        for a in np.unique(n + m):
            anti_diagonal = matrix[np.broadcast_to(n + m == a, matrix.shape)].sum()
            found[t] += anti_diagonal * np.exp(1j * np.pi * a * delay / samples)
    return found


def everything(n, m, samples):
    """The whole matrix: one pixel at the full resolution of the band."""
    return np.ones(np.broadcast_shapes(n.shape, m.shape))


def window(length):
    """A window in time of `length` samples: the mask depends on `m - n` alone."""

    def mask(n, m, samples):
        offsets = np.arange(length) - length // 2
        return np.exp(2j * np.pi * (m - n)[..., None] * offsets / samples).sum(axis=-1)

    return mask


def band(centre, width):
    """A block on the diagonal: a sub-band, in Fourier bins, of which the outermost may belong to it in part."""

    def amplitude(k, samples):
        share = np.clip(width / 2 - np.abs(k - centre) + 0.5, 0.0, 1.0)
        # The Nyquist bin lies at both ends of the band, and is left out.
        return np.sqrt(np.where(2 * np.abs(k) == samples, 0.0, share))

    def mask(n, m, samples):
        return amplitude(n, samples) * amplitude(m, samples)

    return mask
