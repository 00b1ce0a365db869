"""What to expect of a sonar over ground range, without any simulation."""

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from estimators import bounds
from estimators.pixels import PAPER_B, Pixels
from estimators.ranges import Ranges
from estimators.window_sizes import smallest_safe
from sim import SONARS, Sediment, Sonar, checks, expected_coherence, snr
from sim.band import Real
from studies.section import suggestion

LARGEST = 401
"""Largest window that is proposed [pixels on a side]."""


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
    pixels: Pixels = PAPER_B,
    kappa: float = 2.0,
    most_wrap_errors: float = 0.01,
) -> pd.DataFrame:
    """Signal-to-noise ratio, coherence, depth spread, wrap errors and best window over ground range.

    The window is a square of pixels. `depth_std` is that of the exact multilook phase (`bounds.multilook_depth_std`),
    `depth_crlb` its bound (paper B, equation 3), both in the right wrap;
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
    pixels
        The pixels; those of paper B by default.
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
    checks.count("window", window)
    checks.within("kappa", kappa, 0.0, 1e6)
    checks.within("most_wrap_errors", most_wrap_errors, 1e-12, 1.0)
    y = np.atleast_1d(np.asarray(ground_range, dtype=float))
    swath = _swath(sonar, _over_ranges("ground_range", y, y, 0.0, 1e6), sediment, coherence)
    n = _over_ranges("looks", pixels.looks_in(window) if looks is None else looks, y, 1.0, 1e9)
    best = _best_window(_ranges(sonar, swath), pixels, kappa, most_wrap_errors)
    proposed = np.where(best > 0, pixels.looks_in(np.maximum(best, 1)), np.nan)
    found, of_best = (_delivered(sonar, swath, of) for of in (n, proposed))
    return swath.assign(
        looks=n,
        wrap_height=swath.slant_range * sonar.wavelength / sonar.baseline,
        **found,
        best_window=best,
        best_depth_std=of_best["depth_std"],
        best_wrap_error_rate=of_best["wrap_error_rate"],
    )


def _swath(
    sonar: Sonar, ground_range: Real, sediment: Sediment | str | None, coherence: ArrayLike | None
) -> pd.DataFrame:
    """What is heard of a flat seabed at each range: range, angle, signal-to-noise ratio and coherence."""
    if (sediment is None) == (coherence is None):
        raise ValueError("sediment and coherence are both given or both missing; it must be one of them")
    of_seabed = coherence if sediment is None else expected_coherence(sonar, sediment, ground_range)
    gamma = _over_ranges("coherence", of_seabed, ground_range, 0.0, 1.0)
    with np.errstate(divide="ignore"):
        equivalent = 10 * np.log10(bounds.snr_from_coherence(gamma))
    return pd.DataFrame(
        {
            "ground_range": ground_range,
            "slant_range": np.hypot(ground_range, sonar.altitude),
            "grazing_angle": np.degrees(np.arctan2(sonar.altitude, ground_range)),
            "snr_db": equivalent if sediment is None else snr(sonar, sediment, ground_range),
            "coherence": gamma,
        }
    )


def _ranges(sonar: Sonar, swath: pd.DataFrame) -> Ranges:
    slant, gamma = swath.slant_range.to_numpy(), swath.coherence.to_numpy()
    return Ranges(slant, gamma, sonar.centre_frequency, sonar.bandwidth, sonar.baseline, sonar.sound_speed)


def _delivered(sonar: Sonar, swath: pd.DataFrame, looks: Real) -> dict[str, Real]:
    """Spread of the depth in the right wrap, its bound, and rate of wrong wraps, of so many looks at each range."""
    ranges = _ranges(sonar, swath)
    rate = bounds.wrap_error_probability(looks, ranges.coherence, ranges.relative_bandwidth)
    return {
        "depth_std": ranges.depth_std(looks),
        "depth_crlb": ranges.depth_crlb(looks),
        "wrap_error_rate": rate,
    }


def _over_ranges(name: str, given: ArrayLike | None, ground_range: Real, low: float, high: float) -> Real:
    """A value at each range; ValueError for one outside its limits."""
    values = np.broadcast_to(np.asarray(given, dtype=float), ground_range.shape)
    bad = ~((values >= low) & (values <= high))
    if bad.any():
        raise ValueError(f"{name} is {values[bad][0]:g}; it must lie between {low:g} and {high:g}")
    return values


def _best_window(ranges: Ranges, pixels: Pixels, kappa: float, most_wrap_errors: float) -> NDArray[np.int64]:
    """Smallest odd window that meets both conditions, and 0 where none does."""
    sides = np.arange(1, LARGEST + 1, 2)
    looks = np.broadcast_to(pixels.looks_in(sides)[:, None], (sides.size, ranges.coherence.size))
    extent: Real = sides.astype(float) * pixels.along_track

    def few_wraps(tried: NDArray[np.int64]) -> NDArray[np.bool_]:
        rate = bounds.wrap_error_probability(looks[tried, 0], ranges.coherence, ranges.relative_bandwidth)
        return rate <= most_wrap_errors

    return np.append(sides, 0)[smallest_safe(extent, looks, ranges, kappa, few_wraps)]
