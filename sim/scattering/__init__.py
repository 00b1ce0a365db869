"""Backscatter and reflection of the seabed."""

from sim.scattering.strength import Component, Model, reflection_loss, scattering_strength
from sim.scattering.validity import ValidityWarning

__all__ = ["Component", "Model", "ValidityWarning", "reflection_loss", "scattering_strength"]
