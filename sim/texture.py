"""Heavy tails of speckle: how the powers of scatterers must scatter for a K-distributed image."""

from sim.along_track import AlongTrack


def texture_shape(speckle_shape: float, per_resolution: float, along_track: AlongTrack) -> float:
    """Shape of the gamma distribution of scatterer powers that gives an image the second moment of a K distribution.

    A pixel sums scatterers of mean power 1 with the squared weights `g` of the point response. Given the powers `W` it
    is Gaussian with the power `P = sum g W`, so that `<I^2> / <I>^2 = 2 (1 + var P / <P>^2) = 2 (1 + (sum g^2 / (sum
    g)^2) / s)` for powers of shape `s`, and a K distribution has `2 (1 + 1 / nu)`. In range `g = sinc^2`, whose
    integral is 1 and that of its square 2/3, in resolutions of `n` scatterers. A boxcar of as many scatterers would
    give the K distribution itself; the tails of the sinc leave the third moment of the intensity a little higher.

    Parameters
    ----------
    speckle_shape
        `nu` of the image, above 0.
    per_resolution
        Scatterers in a range resolution, `n`.
    along_track
        Rows that share scatterers.
    """
    squares = along_track.weights**2
    return speckle_shape * (2 / 3) / per_resolution * float((squares**2).sum())
