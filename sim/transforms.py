"""Non-uniform FFTs, whose plans are made once a thread: planning takes as long as a third of a row's transform."""

from functools import lru_cache
from threading import get_ident
from typing import Any

import finufft
import numpy as np

from sim.band import Complex, Real

WIDEST = 1e-9
"""Accuracy up to which a grid of 1.25 times the bins is fine enough for a transform to series; beyond, of twice."""


def to_spectrum(phase: Real, amplitudes: Complex, bins: int, accuracy: float) -> Complex:
    """Sums `sum_j a_j exp(-i k x_j)`, a type-1 transform.

    Parameters
    ----------
    phase
        `x_j` [rad], shape (points,).
    amplitudes
        `a_j`, shape (rows, points).
    bins
        How many whole `k` around zero, from the lowest on; odd.
    accuracy
        Relative accuracy.

    Returns
    -------
    array
        Shape (rows, bins).
    """
    return _executed(_plan(get_ident(), 1, bins, len(amplitudes), accuracy, 2.0, 0), phase, amplitudes)


def to_series(phase: Real, spectrum: Complex, accuracy: float, *, fft_order: bool = False) -> Complex:
    """Sums `sum_k s_k exp(i k x_j)`, a type-2 transform.

    Parameters
    ----------
    phase
        `x_j` [rad], shape (points,).
    spectrum
        `s_k`, shape (rows, bins): whole `k` around zero, from the lowest on.
    accuracy
        Relative accuracy.
    fft_order
        Whether the bins stand in the order of an FFT instead, from `k = 0` on.

    Returns
    -------
    array
        Shape (rows, points).
    """
    rows, bins = spectrum.shape
    finer = 1.25 if accuracy >= WIDEST else 2.0
    return _executed(_plan(get_ident(), 2, bins, rows, accuracy, finer, int(fft_order)), phase, spectrum)


def _executed(plan: Any, phase: Real, values: Complex) -> Complex:
    plan.setpts(phase)
    found: Complex = np.atleast_2d(plan.execute(values if len(values) > 1 else values[0]))
    return found


@lru_cache(maxsize=16)
def _plan(thread: int, kind: int, bins: int, rows: int, accuracy: float, finer: float, order: int) -> Any:
    """A plan of one thread; with a grid that does not depend on the points, so that no row depends on those before."""
    sign = -1 if kind == 1 else 1
    return finufft.Plan(
        kind, (bins,), n_trans=rows, eps=accuracy, isign=sign, upsampfac=finer, modeord=order, nthreads=1
    )
