"""What a scene requires of its simulation: which physics, how finely, and what it costs."""

from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from sim import checks
from sim.along_track import AlongTrack
from sim.band import TimeGrid
from sim.costs import costs
from sim.levels import Level
from sim.scene import Scene
from sim.snr_profile import SnrProfile
from sim.sonar import Sonar
from sim.survey import Survey, survey
from sim.time_grid import time_grid

Delays = Literal["scatterers", "warp"]
"""Whether every scatterer has its own delays, or the secondary is a local warp of the primary."""

OVERSAMPLING = 4 / 3
"""Samples in `1 / B`, unless the band shifts further."""


class Decision(NamedTuple):
    """One thing that a plan decides: what is chosen, why, and what it costs.

    Attributes
    ----------
    name, choice, reason
        A field of `Plan`, what it is, and why.
    seconds, bytes
        Time on one core [s] and memory at once [bytes] for all rows, as estimated before running.
    """

    name: str
    choice: Any
    reason: str
    seconds: float
    bytes: float


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How a scene is simulated.

    Attributes
    ----------
    along_track
        Distance of the rows, and the resolution that makes neighbours alike.
    sections
        "one" for all rows, or "each" row its own.
    shadow
        Whether it is found out which parts of the seabed others hide.
    delays
        "scatterers" with their own exact delays at both receivers, walls and layover included; or "warp", the primary
        drawn as one series and the secondary made of it, which takes a seabed that is heard one part at a time.
    baseline
        Whether a warp lets the two angles of view decorrelate; scatterers do it by themselves.
    level
        "even" everywhere; "flat", that of the flat floor over range; "local", that of each piece's sediment and angle.
    scatterers_per_resolution
        Scatterers in a length `c / (2 B)` of seabed, at least 1. Speckle is Gaussian at any density; the mean power is
        uneven by .39, .16, .058, .021 and .007 with 1, 2, 4, 8 and 16.
    accuracy
        Relative accuracy asked of the non-uniform transforms, 1e-14 to 1e-2; what turns the carrier by less is not
        moved. Against 1e-14 the series of a furrowed floor are off by 4.6e-13 and 6.6e-13 (primary, secondary) at
        1e-12, 4e-8 and 1.1e-7 at 2e-7, 4e-7 and 6e-7 at 1e-6, 4e-5 and 6e-5 at 1e-4, 3e-3 and 5e-3 at 1e-2, as root
        mean square over root mean square.
    single
        Whether series come as complex64, half as large and off by 2.5e-8. They are computed in double precision:
        a transform in single precision is off by 1.3e-3, since places lose their last digits.
    grid
        Instants of the samples, at a rate that leaves the registered band below the Nyquist frequency.
    decisions
        The same with reasons and costs.
    """

    along_track: AlongTrack
    sections: Literal["one", "each"]
    shadow: bool
    delays: Delays
    baseline: bool
    level: Level
    scatterers_per_resolution: float
    accuracy: float
    single: bool
    grid: TimeGrid
    decisions: tuple[Decision, ...] = ()

    def __str__(self) -> str:
        width = max(len(d.name) for d in self.decisions)
        lines = [
            f"{d.name:<{width}}  {_short(d.choice):<13}  {d.seconds:8.2g} s  {d.bytes / 1e6:8.3g} MB  {d.reason}"
            for d in self.decisions
        ]
        return "\n".join(lines)


def _short(choice: Any) -> str:
    if isinstance(choice, TimeGrid):
        return f"{choice.samples} samples"
    if isinstance(choice, AlongTrack):
        return f"{choice.spacing * 100:g} cm"
    return f"{choice:g}" if isinstance(choice, float) else str(choice)


def plan(
    scene: Scene,
    sonar: Sonar,
    *,
    snr: float | SnrProfile | None = None,
    rows: int = 1,
    first_row: int = 0,
    row_spacing: float | None = None,
    sample_spacing: float | None = None,
    tolerance: float = 0.02,
    **chosen: Any,
) -> Plan:
    """Find out what a scene requires of its simulation, and what that will cost.

    A shortcut is taken where a look at the section of every row shows that it may be (`sim.survey`).

    Parameters
    ----------
    scene, sonar
        What is seen, and by what.
    rows, first_row, row_spacing
        How many rows, the number of the first and their distance [m]; the along-track resolution, where they are
        independent, if None. Of other rows the plan says nothing.
    sample_spacing
        Distance of the samples in slant range, `c / (2 fs)` [m]; if None, so that `1 / B` holds 4 / 3 of them or more.
    snr
        For a scene without sediment: signal-to-noise ratio of the flat floor [dB], or its profile over range; None for
        no noise.
    tolerance
        Relative error of the spread of an estimate, and unevenness of the mean power, that may go without being
        modelled; 1e-6 to .5.
    chosen
        Fields of `Plan` that are to be as given, whatever the scene requires.

    Returns
    -------
    Plan
        With a reason and a cost for each decision; `print` shows them.

    Raises
    ------
    ValueError
        Where the sonar is not above the scene, for a number outside its limits, samples that do not hold the
        registered band, and for a field that `Plan` lacks.
    """
    checks.count("rows", rows)
    checks.within("tolerance", tolerance, 1e-6, 0.5)
    _check_altitude(scene, sonar)
    resolution = sonar.aperture.resolution
    along_track = AlongTrack(resolution if row_spacing is None else row_spacing, resolution)
    numbers = range(1) if scene.uniform else range(first_row - along_track.halo, first_row + rows + along_track.halo)
    seen = survey(scene, sonar, (number * along_track.spacing for number in numbers), snr)
    rate = _sample_rate(scene, sonar, sample_spacing)
    required = _required(scene, sonar, tolerance, seen, rate, chosen.get("delays"))
    required["along_track"] = along_track, "distance of rows, and the resolution of the aperture"
    for name in chosen:
        checks.one_of("decision", name, sorted(required))
    made = _checked(Plan(**{name: chosen.get(name, choice) for name, (choice, _) in required.items()}), scene)
    reasons = {name: "as asked for" if name in chosen else reason for name, (_, reason) in required.items()}
    return _decided(made, reasons, costs(scene, sonar, made, rows, seen.corners))


def _decided(made: Plan, reasons: dict[str, str], cost: dict[str, tuple[float, float]]) -> Plan:
    decisions = (
        Decision(name, getattr(made, name), reason, *cost.get(name, (0.0, 0.0))) for name, reason in reasons.items()
    )
    return replace(made, decisions=tuple(decisions))


def _check_altitude(scene: Scene, sonar: Sonar) -> None:
    highest = scene.heights[1]
    if sonar.altitude <= highest:
        raise ValueError(
            f"altitude is {sonar.altitude:g} m; it must be above the highest point of the scene, {highest:g} m"
        )


def _sample_rate(scene: Scene, sonar: Sonar, spacing: float | None) -> float:
    """Samples a second that hold the registered band, at a distance in slant range [m] if one is given."""
    plane = survey(Scene(scene.ground_range), sonar, [0.0], None)
    least = 1 + 2.2 * plane.shift
    if spacing is None:
        return sonar.bandwidth * max(OVERSAMPLING, least)
    rate = sonar.sound_speed / (2 * checks.positive("sample_spacing", spacing, "m"))
    if rate < least * sonar.bandwidth:
        most = sonar.range_resolution / least
        raise ValueError(
            f"sample_spacing is {spacing:g} m; it must be at most {most:.4g} m to hold the registered band"
        )
    return rate


def _required(
    scene: Scene, sonar: Sonar, tolerance: float, seen: Survey, rate: float, delays: Delays | None
) -> dict[str, tuple[Any, str]]:
    """Choice and reason of every decision.

    The spread of a phase goes with the root of what coherence lacks of 1, so that leaving out the decorrelation of the
    baseline, a part `p` of that, makes the spread smaller by `p / 2`. So many scatterers are taken that the mean power
    is even within the tolerance: at `n` in a resolution it scatters by about `.46 n^-1.5` (`Plan`).
    """
    needed = seen.overlaid or seen.shift > (min(rate / sonar.bandwidth, OVERSAMPLING) - 1) / 2
    scatterers = needed if delays is None else delays == "scatterers"
    dense = max(1.0, float(np.round((0.46 / tolerance) ** (2 / 3))))
    return {
        "sections": ("one", "the same all along the track") if scene.uniform else ("each", "relief varies along track"),
        "shadow": (seen.shadow, "some parts hide others" if seen.shadow else "no part hides another"),
        "delays": (
            "scatterers" if needed else "warp",
            "several parts are heard at once"
            if seen.overlaid
            else f"the band shifts by up to {seen.shift:.2g} of itself"
            if needed
            else "one part is heard after the other",
        ),
        "baseline": (
            scatterers or seen.decorrelation > 2 * tolerance,
            "scatterers decorrelate by themselves"
            if scatterers
            else f"up to {seen.decorrelation:.2g} of the decorrelation is from the two angles of view",
        ),
        "level": ("even", "no sediment") if scene.sediment is None else ("local", "sediment and local grazing angle"),
        "scatterers_per_resolution": (dense, f"mean power even within {0.46 * dense**-1.5:.2g}"),
        "accuracy": (1e-5 * tolerance, "below the tolerance where it is 100 dB darker than the mean"),
        "single": (False, "half the memory, and errors of 2.5e-8, only if asked for"),
        "grid": (time_grid(scene, sonar, rate), f"{rate / sonar.bandwidth:.3g} samples in 1 / B"),
    }


def _checked(made: Plan, scene: Scene) -> Plan:
    for name, allowed in (("sections", ("one", "each")), ("delays", get_args(Delays)), ("level", get_args(Level))):
        checks.one_of(name, getattr(made, name), allowed)
    for name, kind in (
        ("shadow", bool),
        ("baseline", bool),
        ("single", bool),
        ("along_track", AlongTrack),
        ("grid", TimeGrid),
    ):
        if not isinstance(getattr(made, name), kind):
            raise ValueError(f"{name} is {getattr(made, name)!r}; it must be of type {kind.__name__}")
    if checks.finite("scatterers_per_resolution", made.scatterers_per_resolution) < 1:
        raise ValueError(f"scatterers_per_resolution is {made.scatterers_per_resolution:g}; it must be at least 1")
    checks.within("accuracy", made.accuracy, 1e-14, 1e-2)
    if (made.level == "even") != (scene.sediment is None):
        level = "even for a scene without sediment" if scene.sediment is None else "flat or local for a sediment"
        raise ValueError(f"level is {made.level!r}; it must be {level}")
    return made
