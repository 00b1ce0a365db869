"""Products and sums over series, in one pass over memory: NumPy takes one for each, and makes real factors complex."""

from typing import Any

from numpy.typing import NDArray

from sim.band import Complex, Real
from sim.compiled import compiled


@compiled
def scale(series: Complex, factor: Real) -> None:
    """Multiply a series by real factors, both of shape (samples,)."""
    for sample in range(len(series)):
        series[sample] = complex(series[sample].real * factor[sample], series[sample].imag * factor[sample])


@compiled
def recorded(echo: Complex, gain: Real, noise: Complex, turn: Complex, series: NDArray[Any]) -> None:
    """Write `(gain echo + noise) turn` to a series; all of shape (samples,)."""
    for sample in range(len(series)):
        real = gain[sample] * echo[sample].real + noise[sample].real
        imaginary = gain[sample] * echo[sample].imag + noise[sample].imag
        one, other = turn[sample].real, turn[sample].imag
        series[sample] = complex(real * one - imaginary * other, real * other + imaginary * one)
