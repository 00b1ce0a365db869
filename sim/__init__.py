"""The world: water, seabed, sonar, scene, geometry, echoes."""

from sim.beam import Beam, GaussianBeam, SincBeam
from sim.catalogue import SEDIMENTS
from sim.coherence import CoherenceTerms, coherence_terms, expected_coherence
from sim.echo_pair import EchoPair, Truth
from sim.geometry import Geometry
from sim.rare_errors import DelayErrors, PhaseErrors, SubBandErrors
from sim.rare_speckle import rare_speckle_pair
from sim.scattering import ValidityWarning, reflection_loss, scattering_strength
from sim.scene import Box, Feature, Scene, Wedge
from sim.sediment import ElasticBed, FluidBed, Sediment
from sim.simulate import simulate
from sim.sonar import SONARS, Sonar
from sim.sonar_equation import SonarEquation, snr, sonar_equation
from sim.speckle import speckle_pair
from sim.transducers import Noise, Receiver, SyntheticAperture, Transmitter
from sim.water import Water, absorption

__all__ = [
    "SEDIMENTS",
    "SONARS",
    "Beam",
    "Box",
    "CoherenceTerms",
    "DelayErrors",
    "EchoPair",
    "ElasticBed",
    "Feature",
    "FluidBed",
    "GaussianBeam",
    "Geometry",
    "Noise",
    "PhaseErrors",
    "Receiver",
    "Scene",
    "Sediment",
    "SincBeam",
    "Sonar",
    "SonarEquation",
    "SubBandErrors",
    "SyntheticAperture",
    "Transmitter",
    "Truth",
    "ValidityWarning",
    "Water",
    "Wedge",
    "absorption",
    "coherence_terms",
    "expected_coherence",
    "rare_speckle_pair",
    "reflection_loss",
    "scattering_strength",
    "simulate",
    "snr",
    "sonar_equation",
    "speckle_pair",
]
