"""Products and sums over series, in one pass over memory: NumPy takes one for each, and makes real factors complex."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.band import Complex, Real
from sim.compiled import compiled


@compiled
def scale(series: Complex, factor: Real) -> None:
    """Multiply a series by real factors, both of shape (samples,)."""
    for sample in range(len(series)):
        series[sample] = complex(series[sample].real * factor[sample], series[sample].imag * factor[sample])


@compiled
def turn(series: Complex, turns: Real, factor: Real) -> None:
    """Multiply a series by `factor exp(2 pi i turns)`, all of shape (samples,).

    Within a quarter around a whole number of quarters, `x` up to `pi / 4` away, sine and cosine are their power series
    up to `x^15` and `x^16`: off by 2.5e-16. Ten times as fast as `numpy.exp` of imaginary numbers.
    """
    for sample in range(len(series)):
        part = turns[sample] - np.rint(turns[sample])
        quarter = np.rint(4 * part)
        x = (part - 0.25 * quarter) * (2 * math.pi)
        y = x * x
        sine, cosine = 1.0, 1.0
        for order in range(14, 0, -2):
            sine = 1 - y * sine / (order * (order + 1))
            cosine = 1 - y * cosine / ((order + 1) * (order + 2))
        sine, cosine = x * sine, 1 - y * cosine / 2
        if quarter == 1:
            cosine, sine = -sine, cosine
        elif quarter == -1:
            cosine, sine = sine, -cosine
        elif quarter != 0:
            cosine, sine = -cosine, -sine
        cosine, sine = cosine * factor[sample], sine * factor[sample]
        real, imaginary = series[sample].real, series[sample].imag
        series[sample] = complex(real * cosine - imaginary * sine, real * sine + imaginary * cosine)


@compiled
def recorded(echo: Complex, gain: Real, noise: Complex, turn: Complex, series: NDArray[Any]) -> None:
    """Write `(gain echo + noise) turn` to a series; all of shape (samples,)."""
    for sample in range(len(series)):
        real = gain[sample] * echo[sample].real + noise[sample].real
        imaginary = gain[sample] * echo[sample].imag + noise[sample].imag
        one, other = turn[sample].real, turn[sample].imag
        series[sample] = complex(real * one - imaginary * other, real * other + imaginary * one)
