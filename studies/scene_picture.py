"""A picture of a scene: its relief, what the sonar makes of it, and where it lies in shadow and layover."""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, LightSource, ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from sim import EchoPair, Scene, Sonar, snr
from sim.band import Real
from sim.geometry import travel_times
from sim.profile import Profile, SeabedPoints
from sim.visibility import sees
from studies import figures
from studies.swath import Swath

COLUMNS, LINES = 1200, 200
"""Stretches of ground range, and places along track, that a picture tells apart."""

DYNAMIC_RANGE = 40.0
"""Of the image [dB]."""

SECONDS, FEWEST, MOST = 2.0, 32, 256
"""Time that the simulation is planned to take [s], and the number of its rows."""

RELIEF = colormaps["bone"]

SHADOW, LAYOVER, TARGET = figures.COLOURS[0], figures.COLOURS[4], figures.COLOURS[1]

HEARD = {"one part heard": "white", "shadow": SHADOW, "layover": LAYOVER}
"""Colours of the masks."""

Extent = tuple[float, float, float, float]


def scene_picture(swath: Swath, sonar: Sonar, rng: np.random.Generator) -> Figure:
    """Relief, image intensity, and layover and shadow of a scene over ground range.

    The image has as many rows along track, a resolution cell apart, as are planned to take 2 s, 32 to 256; its pixels
    are means over 1/1200 of the swath, placed where the flat floor is heard at the same time.

    Parameters
    ----------
    swath, sonar
        The scene, and what it is seen by.
    rng
        Source of speckle and noise.

    Returns
    -------
    Figure
        A panel above the other.

    Raises
    ------
    ValueError
        Where the sonar is not above the scene.
    """
    swath = swath.model_copy(update={"row_spacing": None})
    each = sum(decision.seconds for decision in swath.required(sonar, FEWEST).decisions) / FEWEST
    rows = int(np.clip(SECONDS / each, FEWEST, MOST))
    scene, pair = swath.scene(), swath.simulate(sonar, rows, rng)
    figure = Figure(figsize=(9.0, 8.4), layout="constrained")
    axes = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 1.3, 1.0))
    extent = (*scene.ground_range, 0.0, rows * sonar.aperture.resolution)
    if scene.uniform:
        _profile(axes[0], scene.profile(), sonar)
    else:
        _map(axes[0], scene, extent)
    _image(axes[1], pair, scene, extent)
    _masks(axes[2], pair, scene, extent)
    for panel in axes[int(scene.uniform) :]:
        panel.set_ylabel("along track [m]")
    axes[0].set_xlim(scene.ground_range)
    axes[2].set_xlabel("ground range [m]; of image and masks, that of the flat floor heard at the same time")
    named = {name: line for panel in axes for line, name in zip(*panel.get_legend_handles_labels(), strict=True)}
    figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=4, fontsize=9)
    return figure


def _profile(panel: Axes, profile: Profile, sonar: Sonar) -> None:
    """Height over ground range, where it is hidden, and the rays that end where it is seen again."""
    points = _along(profile)
    ground_range, height = profile.position(points)
    hidden = ~sees(profile, points, sonar.altitude)
    panel.plot(ground_range, height, color="black", linewidth=1.2, label="seabed")
    panel.plot(ground_range, np.where(hidden, height, np.nan), color=SHADOW, linewidth=4, label="hidden")
    for end in np.flatnonzero(hidden[:-1] & ~hidden[1:]):
        ray = [0.0, ground_range[end]], [sonar.altitude, height[end]]
        panel.plot(*ray, "--", color="0.5", linewidth=0.8, label="first ray beyond")
    low, high = float(height.min()), float(height.max())
    span = max(high - low, 0.02 * sonar.altitude)
    panel.set_ylim(low - 0.15 * span, high + 0.4 * span)
    panel.set_ylabel("height [m]")
    panel.set_title("Relief", fontsize=10, loc="left")


def _along(profile: Profile) -> SeabedPoints:
    """Points all along a section, its corners among them."""
    corners = np.concatenate([[0.0], np.cumsum(profile.lengths)])
    place = np.union1d(corners, np.linspace(0.0, corners[-1], 4 * COLUMNS))
    segment = np.clip(np.searchsorted(corners, place, "right") - 1, 0, len(profile.lengths) - 1)
    return SeabedPoints(segment, (place - corners[segment]) / profile.lengths[segment])


def _map(panel: Axes, scene: Scene, extent: Extent) -> None:
    """Heights over ground range and along track, lit from the sonar's side."""
    near, far, first, last = extent
    ground_range, places = _middles(near, far, COLUMNS), _middles(first, last, LINES)
    profiles = [scene.profile(float(place)) for place in places]
    height = np.array([np.interp(ground_range, profile.ground_range, profile.height) for profile in profiles])
    low, high = float(height.min()), float(height.max())
    # As steep as makes the relief a tenth of what is seen along track.
    exaggeration = 0.1 * (last - first) / max(high - low, 1e-6)
    shaded = LightSource(azdeg=270, altdeg=35).shade(
        height,
        RELIEF,
        blend_mode="soft",
        vert_exag=exaggeration,
        dx=(far - near) / COLUMNS,
        dy=(last - first) / LINES,
    )
    _drawn(panel, shaded, extent, RELIEF, (low, high))
    _bar(panel, ScalarMappable(Normalize(low, high), RELIEF), "height [m]")
    panel.set_title("Relief, lit from the sonar's side", fontsize=10, loc="left")


def _image(panel: Axes, pair: EchoPair, scene: Scene, extent: Extent) -> None:
    """Mean intensity of the primary in every stretch of ground range, over that of the flat floor with noise."""
    assert pair.geometry is not None
    sonar, edges = pair.geometry.sonar, np.linspace(*scene.ground_range, COLUMNS + 1)
    place = _sample_at(pair, edges)
    before = np.minimum(place.astype(int), pair.shape[1] - 1)
    power = np.abs(pair.primary) ** 2
    summed = (np.cumsum(power, axis=1) - power)[:, before] + (place - before) * power[:, before]
    mean = np.diff(summed, axis=1) / np.diff(place)
    if scene.sediment is not None:
        middles = _middles(*scene.ground_range, COLUMNS)
        mean = mean / (1 + 10 ** (snr(sonar, scene.sediment, middles, model=scene.scattering) / 10))
    level = 10 * np.log10(np.maximum(mean, 1e-12))
    top = float(np.percentile(level, 99.9))
    drawn = _drawn(panel, level, extent, "gray", (top - DYNAMIC_RANGE, top))
    over = "flat floor" if scene.sediment is None else "flat floor and noise"
    _bar(panel, drawn, f"intensity over\n{over} [dB]", "both")
    for target in scene.targets:
        slant = travel_times(sonar, target.ground_range, target.height)[0] * sonar.sound_speed / 2
        where = float(np.sqrt(np.maximum(slant**2 - sonar.altitude**2, 0.0)))
        panel.plot(where, target.along_track, "o", color=TARGET, fillstyle="none", markersize=9, label="point target")
    panel.set_ylim(extent[2:])
    panel.set_title("Image of the primary receiver", fontsize=10, loc="left")


def _masks(panel: Axes, pair: EchoPair, scene: Scene, extent: Extent) -> None:
    """Where a receiver hears no seabed, and where more than one part of it."""
    truth = pair.truth
    assert truth is not None
    assert truth.shadow is not None
    assert truth.layover is not None
    sample = np.rint(_sample_at(pair, _middles(*scene.ground_range, COLUMNS))).astype(int)
    shadow, layover = (np.atleast_2d(mask)[:, sample] for mask in (truth.shadow, truth.layover))
    found = np.where(layover, 2, np.where(shadow, 1, 0))
    for number, (name, colour) in enumerate(HEARD.items()):
        label = f"{name} ({100 * np.mean(found == number):.3g} %)"
        panel.fill_between([], [], facecolor=colour, edgecolor="black", linewidth=0.5, label=label)
    _drawn(panel, found, extent, ListedColormap(list(HEARD.values())), (0, len(HEARD) - 1))
    panel.set_title("Layover and shadow, of either receiver", fontsize=10, loc="left")


def _drawn(
    panel: Axes, values: NDArray[Any], extent: Extent, colours: Colormap | str, limits: tuple[float, float]
) -> AxesImage:
    return panel.imshow(
        values,
        origin="lower",
        aspect="auto",
        interpolation="nearest",
        extent=extent,
        cmap=colours,
        vmin=limits[0],
        vmax=limits[1],
    )


def _bar(panel: Axes, drawn: ScalarMappable, label: str, extend: str = "neither") -> None:
    assert panel.figure is not None
    panel.figure.colorbar(drawn, ax=panel, label=label, extend=extend, pad=0.01, fraction=0.05, aspect=15)


def _sample_at(pair: EchoPair, ground_range: Real) -> Real:
    """Sample at which the flat floor is heard, not always a whole one."""
    assert pair.geometry is not None
    sonar = pair.geometry.sonar
    times = 2 * np.hypot(ground_range, sonar.altitude) / sonar.sound_speed
    sample: Real = np.clip((times - pair.grid.start) * pair.sample_rate, 0, pair.shape[1] - 1)
    return sample


def _middles(first: float, last: float, count: int) -> Real:
    """Middles of so many equal stretches."""
    edges = np.linspace(first, last, count + 1)
    middles: Real = (edges[1:] + edges[:-1]) / 2
    return middles
