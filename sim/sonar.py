"""The sonar: one transmitter, two receivers above each other, one frequency band."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from sim import checks
from sim.transducers import Noise, Receiver, SyntheticAperture, Transmitter
from sim.water import Water


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
        Speed of sound, `c` [m/s]; `in_water` takes it from the water.
    transmitter, receiver, aperture, noise
        What the sonar equation needs besides; the defaults are assumptions (`sim.transducers`).
    water
        The water it stands in, which absorbs.
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
    transmitter: Transmitter = field(default_factory=Transmitter)
    receiver: Receiver = field(default_factory=Receiver)
    aperture: SyntheticAperture = field(default_factory=SyntheticAperture)
    noise: Noise = field(default_factory=Noise)
    water: Water = field(default_factory=Water)
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

    def in_water(self, water: Water) -> "Sonar":
        """The same sonar in other water, with its absorption and its sound speed."""
        return replace(self, water=water, sound_speed=water.sound_speed)

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


NOT_PUBLISHED = (
    "source level, pulse length, vertical beams, directivity, along-track resolution, phase centres and noise, none of "
    "which is published"
)
"""Said of every preset: these are the defaults of `sim.transducers`."""

TUNED_SOURCE_LEVEL = 191.3573
"""Source level of `hisas-1032` [dB re 1 uPa at 1 m]: with the small-slope model coarse sand at 400 m gives -6.4 dB."""

SONARS: Mapping[str, Sonar] = MappingProxyType(
    {
        "hisas-100khz": Sonar(
            centre_frequency=100e3,
            bandwidth=30e3,
            baseline=0.3,
            altitude=15.0,
            assumed="sound speed 1500 m/s, from the 1.5 cm wavelength of paper A; " + NOT_PUBLISHED,
        ),
        "hisas-1032": Sonar(
            centre_frequency=122e3,
            bandwidth=30e3,
            baseline=0.3,
            altitude=42.0,
            sound_speed=1480.0,
            transmitter=Transmitter(source_level=TUNED_SOURCE_LEVEL),
            aperture=SyntheticAperture(resolution=0.0405),
            water=Water(temperature=7.0, salinity=34.0, depth=160.0),
            assumed="bandwidth 30 kHz and sound speed 1480 m/s, which paper B does not give; water of 7 deg C and "
            "salinity 34 at 160 m, where sound goes 1480 m/s; "
            + NOT_PUBLISHED
            + "; of these the source level is tuned, as in paper B, so that coarse sand at 400 m ground range gives "
            "its SNR, -6.4 dB",
        ),
    }
)
"""Sonars by name: `hisas-100khz` of paper A and `hisas-1032` of paper B."""
