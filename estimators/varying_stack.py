"""Lag products under a window that varies with time."""

import numpy as np

from estimators.lag_product import LagStack, extended, lag_product, power, upsampled
from estimators.windows import VaryingWindow
from sim.band import Complex


def varying_lag_stack(
    primary: Complex, secondary: Complex, window: VaryingWindow, factor: int, reach: int, sample_rate: float
) -> LagStack:
    """`lag_stack` for a window that varies: parameters and result are the same.

    Its energies are summed at every lag: a sum made at another time, and moved, would be one over the size there.
    """
    margin = reach // factor + 1
    before, after = (extended(upsampled(series, factor), margin) for series in (primary.conj(), secondary))
    shape = (2 * reach + 1, *primary.shape)
    products, energies = np.empty(shape, dtype=np.complex128), np.empty(shape)
    for products_at, energies_at, lag in zip(products, energies, range(-reach, reach + 1), strict=True):
        products_at[...] = window.sum(lag_product(before, after, lag))
        np.sqrt(window.sum(power(before.at(-lag))), out=energies_at)
        energies_at *= np.sqrt(window.sum(power(after.at(lag))))
    return LagStack(products, energies, 2 / (factor * sample_rate))
