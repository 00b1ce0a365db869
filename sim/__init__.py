"""The world: sonar, scene, geometry, echoes."""

from sim.echo_pair import EchoPair, Truth
from sim.geometry import Geometry
from sim.rare_errors import DelayErrors, PhaseErrors, SubBandErrors
from sim.rare_speckle import rare_speckle_pair
from sim.scene import Box, Feature, Scene, Wedge
from sim.simulate import simulate
from sim.sonar import SONARS, Sonar
from sim.speckle import speckle_pair

__all__ = [
    "SONARS",
    "Box",
    "DelayErrors",
    "EchoPair",
    "Feature",
    "Geometry",
    "PhaseErrors",
    "Scene",
    "Sonar",
    "SubBandErrors",
    "Truth",
    "Wedge",
    "rare_speckle_pair",
    "simulate",
    "speckle_pair",
]
