"""From delays to a depth map: height, where on the ground, how far it can be trusted, how finely it resolves."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimators.estimate import DelayEstimate
from estimators.pixels import Pixels
from estimators.windows import WindowPolicy
from sim import EchoPair, Geometry
from sim.band import Real


@dataclass(frozen=True, eq=False)
class DepthMap:
    """The seabed that delays stand for, seen over a vertical baseline.

    Arrays have the shape of the pair, (rows, time), but for those over time alone; they are finite where `valid`.

    Attributes
    ----------
    height
        Above the reference plane, `z` [m].
    ground_range
        Horizontal distance from the sonar, `y` [m].
    plane_range
        Ground range of the reference plane at each time [m], shape (time,); NaN before its first echo.
    height_std
        Predicted standard deviation of the height while the wrap is right [m].
    wrap_height
        Height that one wrap stands for, `r lambda / D` [m], shape (time,).
    wrap_error_probability, coherence
        Those of the delays.
    resolution_along_track, resolution_range
        Extent of the window on the ground [m], shape (time,).
    cell
        Area of a pixel on the ground [m^2], shape (time,).
    valid
        Where the delay is valid and its echo can come from that height.
    """

    height: Real
    ground_range: Real
    plane_range: Real
    height_std: Real
    wrap_height: Real
    wrap_error_probability: Real
    coherence: Real
    resolution_along_track: Real
    resolution_range: Real
    cell: Real
    valid: NDArray[np.bool_]


def depth_map(
    pair: EchoPair, estimate: DelayEstimate, window: WindowPolicy, *, pixels: Pixels | None = None
) -> DepthMap:
    """Heights of the seabed from the delays of a registered pair.

    The height is `Geometry.height`, exact for a vertical baseline with one transmitter, and the ground range follows
    from it and the slant range, `y = sqrt(r^2 - (H - z)^2)`. The spread is half the difference of the heights one
    standard deviation of the delay to either side; to first order it is `r c / D` times that of the delay, and
    `bounds.depth_crlb` where this is `bounds.phase_crlb` over `2 pi fc`.

    Parameters
    ----------
    pair
        The pair, with its geometry.
    estimate
        Its delays.
    window
        The window or policy that they were estimated with: it gives the horizontal resolution.
    pixels
        The pixels on the ground; where None, those of the pair, `Pixels.of`.

    Returns
    -------
    DepthMap
        Of the shape of the pair.

    Raises
    ------
    ValueError
        For a pair without geometry.
    """
    geometry = pair.geometry
    if geometry is None:
        raise ValueError("the pair has no geometry; it must have one to place its delays")
    times, sonar = pair.grid.times, geometry.sonar
    height = geometry.height(times, estimate.delay)
    ground_range = geometry.ground_range(times, height)
    pixels = Pixels.of(pair, geometry) if pixels is None else pixels
    sizes = window.on(pair)
    over_time = pair.shape[1:]
    return DepthMap(
        height=height,
        ground_range=ground_range,
        plane_range=geometry.ground_range(times),
        height_std=_spread(geometry, times, estimate),
        wrap_height=geometry.slant_range(times) * sonar.wavelength / sonar.baseline,
        wrap_error_probability=estimate.wrap_error_probability,
        coherence=estimate.coherence,
        resolution_along_track=np.broadcast_to(np.asarray(sizes.rows * pixels.along_track), over_time),
        resolution_range=np.broadcast_to(np.asarray(sizes.samples * pixels.range), over_time),
        cell=np.broadcast_to(np.asarray(pixels.along_track * pixels.range), over_time),
        valid=estimate.valid & np.isfinite(height) & np.isfinite(ground_range),
    )


def _spread(geometry: Geometry, times: Real, estimate: DelayEstimate) -> Real:
    one, other = (geometry.height(times, estimate.delay + sign * estimate.delay_std) for sign in (-1.0, 1.0))
    return np.abs(other - one) / 2
