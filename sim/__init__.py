"""The world: water, seabed, sonar, scene, geometry, echoes."""

from sim.along_track import AlongTrack
from sim.beam import Beam, GaussianBeam, SincBeam
from sim.catalogue import SEDIMENTS
from sim.coherence import CoherenceTerms, coherence_terms, expected_coherence
from sim.echo_pair import EchoPair, Truth
from sim.features import Box, Feature, Slope, Step, TrawlMark, Wedge
from sim.geometry import Geometry
from sim.pair_reading import PairFile, open_pair, read_pair
from sim.pair_writing import write_pair
from sim.plan import Decision, Plan, plan
from sim.rare_errors import DelayErrors, PhaseErrors, SubBandErrors
from sim.rare_speckle import rare_speckle_pair
from sim.relief import HeightMap, Roughness
from sim.scattering import ValidityWarning, reflection_loss, scattering_strength
from sim.scene import PointTarget, Scene, SedimentPatch
from sim.sediment import ElasticBed, FluidBed, Sediment
from sim.simulate import echo_blocks, simulate
from sim.snr_profile import SnrProfile
from sim.sonar import SONARS, Sonar
from sim.sonar_equation import SonarEquation, snr, sonar_equation
from sim.speckle import speckle_pair
from sim.transducers import Noise, Receiver, SyntheticAperture, Transmitter
from sim.water import Water, absorption

__all__ = [
    "SEDIMENTS",
    "SONARS",
    "AlongTrack",
    "Beam",
    "Box",
    "CoherenceTerms",
    "Decision",
    "DelayErrors",
    "EchoPair",
    "ElasticBed",
    "Feature",
    "FluidBed",
    "GaussianBeam",
    "Geometry",
    "HeightMap",
    "Noise",
    "PairFile",
    "PhaseErrors",
    "Plan",
    "PointTarget",
    "Receiver",
    "Roughness",
    "Scene",
    "Sediment",
    "SedimentPatch",
    "SincBeam",
    "Slope",
    "SnrProfile",
    "Sonar",
    "SonarEquation",
    "Step",
    "SubBandErrors",
    "SyntheticAperture",
    "Transmitter",
    "TrawlMark",
    "Truth",
    "ValidityWarning",
    "Water",
    "Wedge",
    "absorption",
    "coherence_terms",
    "echo_blocks",
    "expected_coherence",
    "open_pair",
    "plan",
    "rare_speckle_pair",
    "read_pair",
    "reflection_loss",
    "scattering_strength",
    "simulate",
    "snr",
    "sonar_equation",
    "speckle_pair",
    "write_pair",
]
