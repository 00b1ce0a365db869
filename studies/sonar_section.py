"""The sonar of a study file."""

from dataclasses import replace

from pydantic import field_validator

from sim import SONARS, Sonar
from studies.quantity import Hertz, Metres, MetresPerSecond
from studies.section import Section, suggestion


class SonarSection(Section):
    """A sonar by name, or by its parameters; parameters given beside a name replace its own.

    Parameters
    ----------
    preset
        A name of `sim.SONARS`; without one all parameters but the sound speed must be given.
    centre_frequency, bandwidth, baseline, altitude, sound_speed
        As of `sim.Sonar`.
    """

    preset: str | None = None
    centre_frequency: Hertz | None = None
    bandwidth: Hertz | None = None
    baseline: Metres | None = None
    altitude: Metres | None = None
    sound_speed: MetresPerSecond | None = None

    @field_validator("preset")
    @classmethod
    def _known(cls, name: str | None) -> str | None:
        if name is not None and name not in SONARS:
            raise ValueError(f"it must be {suggestion(name, SONARS)}")
        return name

    def sonar(self) -> Sonar:
        """As the simulator knows it; ValueError where a parameter is missing or cannot be."""
        given = self.model_dump(exclude_none=True, exclude={"preset"})
        if self.preset is not None:
            return replace(SONARS[self.preset], **given)
        for name in ("centre_frequency", "bandwidth", "baseline", "altitude"):
            if name not in given:
                raise ValueError(f"{name} is missing; it must be given, or a preset of {', '.join(SONARS)}")
        return Sonar(**given)
