"""A section of a scene, and what the primary hears of it."""

from typing import NamedTuple

from sim.heard import Heard
from sim.profile import Profile


class Section(NamedTuple):
    """A section, and what of it the primary hears at the times of the grid."""

    profile: Profile
    heard: Heard
