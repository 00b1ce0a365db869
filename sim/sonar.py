"""The sonar: one transmitter, two receivers above each other, one frequency band."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from sim import checks


@dataclass(frozen=True, kw_only=True)
class Sonar:
    """An interferometric sonar over a flat reference plane.

    The transmitter and the primary receiver stand at `altitude`, the secondary receiver `baseline`
    above them (theory: paper A, figure 1).

    Parameters
    ----------
    centre_frequency
        Centre of the band, `fc` [Hz].
    bandwidth
        Width of the flat band, `B` [Hz], below `2 fc`.
    baseline
        Vertical distance of the receivers, `D` [m].
    altitude
        Height of the primary receiver above the reference plane, `H` [m].
    sound_speed
        Speed of sound, `c` [m/s].
    assumed
        What is not published of this sonar and was assumed, in words.

    Raises
    ------
    ValueError
        For a value outside these limits.
    """

    centre_frequency: float
    bandwidth: float
    baseline: float
    altitude: float
    sound_speed: float = 1500.0
    assumed: str = ""

    def __post_init__(self) -> None:
        checks.positive("centre_frequency", self.centre_frequency, "Hz")
        checks.positive("bandwidth", self.bandwidth, "Hz")
        checks.positive("baseline", self.baseline, "m")
        checks.positive("altitude", self.altitude, "m")
        checks.positive("sound_speed", self.sound_speed, "m/s")
        if self.bandwidth >= 2 * self.centre_frequency:
            raise ValueError(
                f"bandwidth is {self.bandwidth:g} Hz; it must be below twice the centre frequency, "
                f"{2 * self.centre_frequency:g} Hz"
            )

    @property
    def wavelength(self) -> float:
        """Wavelength at the centre frequency, `c / fc` [m]."""
        return self.sound_speed / self.centre_frequency

    @property
    def relative_bandwidth(self) -> float:
        """`B / fc`."""
        return self.bandwidth / self.centre_frequency

    @property
    def wrap(self) -> float:
        """Delay of one wrap, `1 / fc` [s]."""
        return 1 / self.centre_frequency

    @property
    def range_resolution(self) -> float:
        """Slant-range resolution, `c / (2 B)` [m]."""
        return self.sound_speed / (2 * self.bandwidth)


SONARS: Mapping[str, Sonar] = MappingProxyType(
    {
        "hisas-100khz": Sonar(
            centre_frequency=100e3,
            bandwidth=30e3,
            baseline=0.3,
            altitude=15.0,
            assumed="sound speed 1500 m/s, from the 1.5 cm wavelength of paper A",
        ),
        "hisas-1032": Sonar(
            centre_frequency=122e3,
            bandwidth=30e3,
            baseline=0.3,
            altitude=42.0,
            sound_speed=1480.0,
            assumed="bandwidth 30 kHz and sound speed 1480 m/s; paper B gives neither",
        ),
    }
)
"""Sonars by name: `hisas-100khz` of paper A and `hisas-1032` of paper B."""
