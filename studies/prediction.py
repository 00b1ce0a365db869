"""What to expect of a sonar over ground range, without any simulation."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from estimators import bounds
from sim import SONARS, Sediment, Sonar, checks, expected_coherence, snr
from sim.band import Real
from studies.section import suggestion

LARGEST = 401
"""Largest window that is proposed [pixels on a side]."""


@dataclass(frozen=True, kw_only=True)
class ImageGrid:
    """The pixels of an image: squares of independent looks.

    Parameters
    ----------
    pixel
        Side of a pixel on the ground, `d xi` [m].
    looks_per_pixel
        Independent looks in a pixel, `alpha`, above 0 and at most 1; .4 for the images of paper B.
    """

    pixel: float = 0.02
    looks_per_pixel: float = 0.4

    def __post_init__(self) -> None:
        checks.positive("pixel", self.pixel, "m")
        checks.positive("looks_per_pixel", self.looks_per_pixel)
        checks.within("looks_per_pixel", self.looks_per_pixel, 0.0, 1.0)

    def looks(self, pixels: ArrayLike) -> Real:
        """Looks in a square window, `N = alpha M^2` (paper B, equation 1)."""
        looks: Real = self.looks_per_pixel * np.square(np.asarray(pixels, dtype=float))
        return looks


def sonar_of(name: str) -> Sonar:
    """A sonar by its name; ValueError for an unknown one."""
    if name not in SONARS:
        raise ValueError(f"sonar is {name!r}; it must be {suggestion(name, SONARS)}")
    return SONARS[name]


def predict(
    sonar: Sonar,
    ground_range: ArrayLike,
    *,
    sediment: Sediment | str | None = None,
    coherence: ArrayLike | None = None,
    window: int = 9,
    looks: ArrayLike | None = None,
    grid: ImageGrid | None = None,
    kappa: float = 2.0,
    most_wrap_errors: float = 0.01,
) -> pd.DataFrame:
    """Signal-to-noise ratio, coherence, depth spread, wrap errors and best window over ground range.

    The window is a square of pixels. `depth_std` is that of the exact multilook phase, `(r c / D) std(phi) / (2 pi fc)`
    (theory of `bounds.multilook_phase_std`), `depth_crlb` its bound (paper B, equation 3), both in the right wrap;
    `wrap_error_rate` is that of the cross-correlation over the same window, `bounds.wrap_error_probability`. The best
    window is the smallest odd one that is no smaller than `kappa` times the depth spread that it gives (paper B,
    equation 6) and whose wrap-error rate is at most `most_wrap_errors`.

    Parameters
    ----------
    sonar
        The sonar over a flat seabed.
    ground_range
        Ground ranges [m], shape (range,).
    sediment
        The seabed; coherence follows from the sonar equation and the geometry.
    coherence
        The coherence itself instead, 0 to 1; one number, or one for each range.
    window
        Side of the window [pixels].
    looks
        Independent looks in it instead, at least 1; one number, or one for each range.
    grid
        The pixels; those of paper B where None.
    kappa
        Size of the window over spread of the depth; 0 asks for none.
    most_wrap_errors
        Largest wrap-error rate of the best window.

    Returns
    -------
    DataFrame
        A row for each range: ground_range, slant_range [m], grazing_angle [degrees], snr_db (of one receiver; that
        which gives the coherence where only this is stated), coherence, looks, wrap_height [m], depth_std, depth_crlb
        [m], wrap_error_rate, best_window [pixels; 0 where even 401 do not do], best_depth_std, best_wrap_error_rate.

    Raises
    ------
    ValueError
        Unless one of sediment and coherence is given, and for a value outside its limits.
    """
    grid = ImageGrid() if grid is None else grid
    checks.count("window", window)
    checks.within("kappa", kappa, 0.0, 1e6)
    checks.within("most_wrap_errors", most_wrap_errors, 1e-12, 1.0)
    if (sediment is None) == (coherence is None):
        raise ValueError("sediment and coherence are both given or both missing; it must be one of them")
    y = np.atleast_1d(np.asarray(ground_range, dtype=float))
    y = _over_ranges("ground_range", y, y, 0.0, 1e6)
    of_seabed = coherence if sediment is None else expected_coherence(sonar, sediment, y)
    gamma = _over_ranges("coherence", of_seabed, y, 0.0, 1.0)
    n = _over_ranges("looks", grid.looks(window) if looks is None else looks, y, 1.0, 1e9)
    swath = _Swath(sonar, np.hypot(y, sonar.altitude), gamma)
    best = _best_window(swath, grid, kappa, most_wrap_errors)
    proposed = np.where(best > 0, grid.looks(np.maximum(best, 1)), np.nan)
    with np.errstate(divide="ignore"):
        equivalent = 10 * np.log10(bounds.snr_from_coherence(gamma))
    return pd.DataFrame(
        {
            "ground_range": y,
            "slant_range": swath.slant_range,
            "grazing_angle": np.degrees(np.arctan2(sonar.altitude, y)),
            "snr_db": equivalent if sediment is None else snr(sonar, sediment, y),
            "coherence": gamma,
            "looks": n,
            "wrap_height": swath.slant_range * sonar.wavelength / sonar.baseline,
            "depth_std": swath.depth_std(n),
            "depth_crlb": swath.depth_crlb(n),
            "wrap_error_rate": swath.wrap_errors(n),
            "best_window": best,
            "best_depth_std": swath.depth_std(proposed),
            "best_wrap_error_rate": swath.wrap_errors(proposed),
        }
    )


def _over_ranges(name: str, given: ArrayLike | None, ground_range: Real, low: float, high: float) -> Real:
    """A value at each range; ValueError for one outside its limits."""
    values = np.broadcast_to(np.asarray(given, dtype=float), ground_range.shape)
    bad = ~((values >= low) & (values <= high))
    if bad.any():
        raise ValueError(f"{name} is {values[bad][0]:g}; it must lie between {low:g} and {high:g}")
    return values


@dataclass(frozen=True)
class _Swath:
    """Slant range and coherence of each range."""

    sonar: Sonar
    slant_range: Real
    coherence: Real

    def depth_std(self, looks: Real) -> Real:
        sonar = self.sonar
        of_phase = self.slant_range * sonar.wavelength / (2 * np.pi * sonar.baseline)
        std: Real = of_phase * bounds.multilook_phase_std(looks, self.coherence)
        return std

    def depth_crlb(self, looks: Real) -> Real:
        sonar = self.sonar
        return bounds.depth_crlb(
            looks, self.coherence, sonar.centre_frequency, self.slant_range, sonar.baseline, sonar.sound_speed
        )

    def wrap_errors(self, looks: Real) -> Real:
        return bounds.wrap_error_probability(looks, self.coherence, self.sonar.relative_bandwidth)


def _best_window(swath: _Swath, grid: ImageGrid, kappa: float, most_wrap_errors: float) -> NDArray[np.int64]:
    """Smallest odd window that meets both conditions, by halving; both are easier to meet the larger it is."""
    first = int(np.ceil(np.sqrt(1 / grid.looks_per_pixel)))
    first += 1 - first % 2
    low = np.full(swath.coherence.shape, (first - 1) // 2)
    high = np.full(swath.coherence.shape, LARGEST // 2 + 1)
    while np.any(low < high):
        middle = (low + high) // 2
        pixels = 2 * middle + 1
        looks = grid.looks(pixels)
        enough = (pixels * grid.pixel >= kappa * swath.depth_std(looks)) & (
            swath.wrap_errors(looks) <= most_wrap_errors
        )
        low, high = np.where(enough | (low >= high), low, middle + 1), np.where(enough, middle, high)
    best: NDArray[np.int64] = np.where(2 * low + 1 <= LARGEST, 2 * low + 1, 0)
    return best
