"""The shipped studies, by name."""

from collections.abc import Mapping
from types import MappingProxyType

from studies.catalogue.box_scene import BoxScene
from studies.catalogue.wrap_errors import WrapErrors
from studies.study import Study

STUDIES: Mapping[str, type[Study]] = MappingProxyType({study.name: study for study in (BoxScene, WrapErrors)})
"""Study classes by name; each is made without arguments."""
