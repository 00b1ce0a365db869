"""Heavy tails of speckle: how the powers of scatterers must scatter for a K-distributed image."""

import numpy as np

from sim.along_track import AlongTrack
from sim.band import Real

TAIL = 64
"""Resolutions to either side over which the point response is summed; what lies beyond is 1e-7 of the sum."""


def texture_shape(speckle_shape: float, in_range: float | Real, along_track: AlongTrack) -> float | Real:
    """Shape of the gamma distribution of scatterer powers that gives an image the second moment of a K distribution.

    A pixel sums scatterers of mean power 1 with the squared weights `g` of the point response. Given the powers `W` it
    is Gaussian with the power `P = sum g W`, so that `<I^2> / <I>^2 = 2 (1 + var P / <P>^2) = 2 (1 + c / s)` for powers
    of shape `s`, with `c = sum g^2 / (sum g)^2`, and a K distribution has `2 (1 + 1 / nu)`. A boxcar of as many
    scatterers would give the K distribution itself; the tails of the sinc leave the higher moments of the intensity a
    little higher.

    Parameters
    ----------
    speckle_shape
        `nu` of the image, above 0.
    in_range
        `c` of the point response in range (`scattered`, `sampled`); a number, or one for each scatterer.
    along_track
        Rows that share scatterers, whose weights give the other factor of `c`.
    """
    squares = along_track.weights**2
    return speckle_shape * in_range * float((squares**2).sum())


def scattered(per_resolution: float | Real) -> float | Real:
    """`c` of the range response `g = sinc^2` for scatterers at random places, `n` in a resolution: `2 / (3 n)`."""
    return 2 / (3 * per_resolution)


def sampled(per_resolution: float) -> float:
    """`c` of the range response `g = sinc^2` for scatterers on the samples of a series, so many in a resolution.

    Seen at the samples; more than `scattered` below two in a resolution, as `g^2` is then sampled too coarsely.
    """
    places = np.arange(-int(TAIL * per_resolution), int(TAIL * per_resolution) + 1) / per_resolution
    return float((np.sinc(places) ** 4).sum()) / per_resolution**2
