"""How a cost grows with a size: a power law beside a fixed cost, fitted to what was measured."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from sim.band import Real


class PowerLaw(NamedTuple):
    """`cost = fixed + scale size^exponent`.

    `exponent_se` is the standard error of the exponent; NaN where there are no more measurements than unknowns.
    """

    exponent: float
    exponent_se: float
    scale: float
    fixed: float

    def at(self, size: ArrayLike) -> Real:
        """The cost of a size."""
        cost: Real = self.fixed + self.scale * np.asarray(size, dtype=float) ** self.exponent
        return cost


def power_law(size: ArrayLike, cost: ArrayLike, *, fixed: bool) -> PowerLaw:
    """Least squares in `log cost`, so that every size weighs alike.

    The standard error follows from the residuals `r`: the covariance is `s^2 (J^T J)^-1` with `s^2 = sum r^2 / (m -
    unknowns)`. A fixed cost that comes out at nothing is left out and no longer counts as an unknown.

    Parameters
    ----------
    size, cost
        Above 0, shape (m,).
    fixed
        Whether a fixed cost is looked for. Beside a cost that does not grow it cannot be told from it.

    Raises
    ------
    ValueError
        For values that are not above 0, and for fewer sizes than unknowns.
    """
    n, t = (np.asarray(values, dtype=float) for values in (size, cost))
    if n.shape != t.shape or n.ndim != 1 or not (n > 0).all() or not (t > 0).all():
        raise ValueError(f"size and cost have the shapes {n.shape} and {t.shape}; they must be one, and all above 0")
    unknowns, sizes = 3 if fixed else 2, len(np.unique(n))
    if sizes < unknowns:
        raise ValueError(f"there are {sizes} sizes; {unknowns} unknowns take as many at least")
    # About the middle of the sizes exponent and scale are nearly independent.
    middle = float(np.exp(np.mean(np.log(n))))
    x, y = np.log(n / middle), np.log(t)
    straight = np.polyfit(x, y, 1)
    found, jacobian = straight, np.stack([x, np.ones_like(x)], axis=1)
    residual, beside = y - np.polyval(straight, x), 0.0
    if fixed:
        solved = _beside_fixed_cost(x, y)
        if solved.x[2] > 0:
            found, jacobian, residual = solved.x, solved.jac, solved.fun
            beside = float(solved.x[2] * t.min())
    free = len(n) - jacobian.shape[1]
    variance = float(residual @ residual) / free if free else np.nan
    error = float(np.sqrt(variance * np.linalg.inv(jacobian.T @ jacobian)[0, 0]))
    return PowerLaw(float(found[0]), error, float(np.exp(found[1] - found[0] * np.log(middle))), beside)


def _beside_fixed_cost(x: Real, y: Real) -> Any:
    """Exponent, log scale, and fixed cost in parts of the least cost, which is not below nothing."""

    def residual(unknown: Real) -> Real:
        exponent, offset, part = unknown
        found: Real = np.log(part * np.exp(y.min()) + np.exp(offset + exponent * x)) - y
        return found

    # The largest sizes tell the exponent where a fixed cost hides it at the smallest.
    last, before = np.argsort(x, kind="stable")[[-1, -2]]
    slope = (y[last] - y[before]) / (x[last] - x[before]) if x[last] > x[before] else 1.0
    begin = [slope, y[last] - slope * x[last], 0.1]
    bounds = ([-np.inf, -np.inf, 0.0], [np.inf, np.inf, 1.0])
    return least_squares(residual, begin, bounds=bounds, x_scale=[0.1, 0.1, 0.1], xtol=1e-12, ftol=1e-12)
