"""The world: sonar, scene, geometry, echoes."""

from sim.echo_pair import EchoPair, Truth
from sim.geometry import Geometry
from sim.scene import Box, Feature, Scene, Wedge
from sim.simulate import simulate
from sim.sonar import SONARS, Sonar
from sim.speckle import speckle_pair

__all__ = [
    "SONARS",
    "Box",
    "EchoPair",
    "Feature",
    "Geometry",
    "Scene",
    "Sonar",
    "Truth",
    "Wedge",
    "simulate",
    "speckle_pair",
]
