"""A sonar that listens to a scene: what all rows of its echoes have in common."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sim.band import Band, Complex, Real
from sim.geometry import Geometry, plane_delay
from sim.levels import range_gain
from sim.plan import Plan
from sim.registration import Resampling, registration
from sim.scene import Scene
from sim.sonar import Sonar


@dataclass(frozen=True, eq=False)
class Listening:
    """A scene, a sonar, and a plan of what is modelled."""

    scene: Scene
    sonar: Sonar
    plan: Plan

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
        delay = plane_delay(self.sonar, self.plan.grid.times)
        factor: Complex = np.exp(-2j * np.pi * self.sonar.centre_frequency * delay)
        return factor

    @cached_property
    def gain(self) -> Real:
        """Amplitude that echoes keep on their way, shape (samples,)."""
        return range_gain(self.sonar, self.plan.grid.times)
