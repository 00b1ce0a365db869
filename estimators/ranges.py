"""How well a depth can be told over range."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from estimators import bounds
from sim.band import Real


@dataclass(frozen=True, eq=False)
class Ranges:
    """What decides the spread of a depth at each of some ranges, the wrap being known.

    Attributes
    ----------
    slant_range, coherence
        `r` [m] and `gamma`, shape (range,).
    centre_frequency, bandwidth
        `fc` and `B` [Hz].
    baseline, sound_speed
        `D` [m] and `c` [m/s].
    """

    slant_range: Real
    coherence: Real
    centre_frequency: float
    bandwidth: float
    baseline: float
    sound_speed: float

    @property
    def relative_bandwidth(self) -> float:
        """`B / fc`."""
        return self.bandwidth / self.centre_frequency

    def depth_crlb(self, looks: ArrayLike) -> Real:
        """Bound of the depth [m] (paper B, equation 3)."""
        return bounds.depth_crlb(
            looks, self.coherence, self.centre_frequency, self.slant_range, self.baseline, self.sound_speed
        )

    def depth_std(self, looks: ArrayLike) -> Real:
        """Standard deviation of the depth from the exact multilook phase [m]: the bound's, with `std(phi)` in it."""
        return bounds.multilook_depth_std(
            looks, self.coherence, self.centre_frequency, self.slant_range, self.baseline, self.sound_speed
        )
