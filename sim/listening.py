"""A sonar that listens to a scene: what all rows of its echoes have in common."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.band import Band, Complex, Real
from sim.geometry import Geometry
from sim.levels import range_gain
from sim.plan import Plan
from sim.registration import Resampling, registration
from sim.scene import Scene
from sim.snr_profile import SnrProfile
from sim.sonar import Sonar


@dataclass(frozen=True, eq=False)
class Listening:
    """A scene, a sonar, a plan of what is modelled, and the signal-to-noise ratio where no sediment says it.

    A profile of it is laid on the echoes, as the sonar equation is, beside noise of unit power; a number on the noise,
    beside a floor of unit power.
    """

    scene: Scene
    sonar: Sonar
    plan: Plan
    snr: float | SnrProfile | None = None

    @cached_property
    def band(self) -> Band:
        """Band of the series, on the grid of the plan."""
        return Band(self.plan.grid, self.sonar.bandwidth)

    @cached_property
    def geometry(self) -> Geometry:
        """Geometry of the registered pair."""
        return Geometry(self.sonar, self.plan.grid.start)

    @cached_property
    def registration(self) -> Resampling:
        """What registers a secondary."""
        return registration(self.band, self.sonar, self.plan.accuracy)

    @cached_property
    def recorded_carrier(self) -> Complex:
        """Factor that takes registered series to the carrier at which they were recorded, shape (samples,)."""
        factor: Complex = self.registration.turn.conj()
        return factor

    @cached_property
    def gain(self) -> Real:
        """Amplitude that echoes keep on their way, shape (samples,)."""
        if self.scene.sediment is not None:
            return range_gain(self.sonar, self.plan.grid.times)
        if isinstance(self.snr, SnrProfile):
            return self.floor(self.plan.grid.times)
        return np.ones(self.plan.grid.samples)

    def floor(self, time: Real) -> Real:
        """Amplitude of the flat floor that a profile says at times at the primary [s], of their shape; 1 without."""
        if not isinstance(self.snr, SnrProfile):
            return np.ones(np.shape(time))
        slant = time * self.sonar.sound_speed / 2
        ground_range = np.sqrt(np.maximum(slant**2 - self.sonar.altitude**2, 0.0))
        amplitude: Real = 10 ** (self.snr.at(ground_range) / 20)
        return amplitude

    @property
    def noise(self) -> float:
        """Amplitude of the noise."""
        if self.scene.sediment is not None or isinstance(self.snr, SnrProfile):
            return 1.0
        return 0.0 if self.snr is None else 10 ** (-self.snr / 20)
