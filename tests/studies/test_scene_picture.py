"""Pictures of scenes, and what `check` says of them."""

import numpy as np
import pytest
from typer.testing import CliRunner

from sim import SONARS
from studies import catalogue, scene_picture
from studies.cli import app
from studies.swath import Swath

SONAR = SONARS["hisas-100khz"]


def drawn(swath, monkeypatch, sonar=SONAR):
    monkeypatch.setattr(scene_picture, "MOST", 32)
    figure = scene_picture.scene_picture(swath, sonar, np.random.default_rng(1))
    figure.draw_without_rendering()
    return figure


def of_floor(ground_range, height):
    """Ground range of the floor that is as far from the sonar, 15 m high, as a point."""
    return np.sqrt(ground_range**2 + (15 - height) ** 2 - 15**2)


def test_a_box_throws_its_shadow_and_lies_over_the_floor_where_geometry_has_it(monkeypatch):
    swath = Swath(
        ground_range=(90.0, 180.0), features=[{"kind": "box", "start": 110, "width": 10, "height": 3}], snr=20
    )
    figure = drawn(swath, monkeypatch)
    relief, image, masks = figure.axes[:3]
    mask = masks.images[0].get_array()
    assert mask.shape == (1, scene_picture.COLUMNS)
    ground_range = 90 + 90 * (np.arange(scene_picture.COLUMNS) + 0.5) / scene_picture.COLUMNS
    shadow, layover = ground_range[mask[0] == 1], ground_range[mask[0] == 2]
    # From the far edge of the top to where its ray meets the floor, 120 m times 15 / 12.
    assert (shadow[0], shadow[-1]) == (pytest.approx(of_floor(120, 3), abs=0.1), pytest.approx(150.0, abs=0.2))
    assert (layover[0], layover[-1]) == (pytest.approx(of_floor(110, 3), abs=0.1), pytest.approx(110.0, abs=0.1))
    level = np.asarray(image.images[0].get_array())
    assert level.shape == (32, scene_picture.COLUMNS)
    # The power of the floor with its noise, and of the noise alone.
    for inside, expected in ((ground_range < 108, 1.01), (abs(ground_range - 135) < 10, 0.01)):
        assert np.mean(10 ** (level[:, inside] / 10)) == pytest.approx(expected, rel=0.05)
    assert relief.get_ylim()[1] > 3
    hidden = next(line for line in relief.lines if line.get_label() == "hidden")
    assert np.nanmax(hidden.get_xdata()[np.isfinite(hidden.get_ydata())]) == pytest.approx(150.0, abs=0.1)


def test_a_scene_that_varies_is_a_map_and_a_point_target_is_where_it_lies(monkeypatch):
    swath = Swath(
        ground_range=(60.0, 66.0),
        features=[{"kind": "box", "start": 64, "width": 1, "height": 0.3, "along_track": [0.5, 2.0]}],
        targets=[{"ground_range": 62.0, "along_track": 0.6, "level": 40}],
        snr=10,
    )
    figure = drawn(swath, monkeypatch)
    relief, image = figure.axes[:2]
    assert relief.get_ylabel() == image.get_ylabel() == "along track [m]"
    height = np.asarray(relief.images[0].get_array())
    assert height.shape[:2] == (scene_picture.LINES, scene_picture.COLUMNS)
    level = np.asarray(image.images[0].get_array())
    row, column = np.unravel_index(level.argmax(), level.shape)
    # Rows of 3 cm.
    assert row == 20
    assert 60 + 6 * (column + 0.5) / scene_picture.COLUMNS == pytest.approx(62.0, abs=SONAR.range_resolution)


def test_levels_of_a_sediment_are_even_over_range(monkeypatch):
    swath = Swath(ground_range=(60.0, 300.0), sediment="coarse sand", features=[])
    figure = drawn(swath, monkeypatch, SONARS["hisas-1032"])
    power = 10 ** (np.asarray(figure.axes[1].images[0].get_array()) / 10)
    for part in np.split(power, 4, axis=1):
        # 32 rows of some 50 m / 2.5 cm / 2 looks.
        assert part.mean() == pytest.approx(1.0, abs=5 / np.sqrt(32 * 1000))


def test_check_prints_the_plan_and_draws(tmp_path, monkeypatch):
    monkeypatch.setattr(scene_picture, "MOST", 32)
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(app, ["check", "box-scene", "--plot"])
    assert found.exit_code == 0, found.output
    assert "simulation of 2 rows" in found.output
    assert "delays                     scatterers" in found.output
    assert "several parts are heard at once" in found.output
    assert (tmp_path / "box-scene.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["wrap-errors", "--plot"], "twinecho: wrap-errors has no scene; --plot must be for one that has"),
        (["snr-versus-range", "--plot"], "twinecho: snr-versus-range has no scene; --plot must be for one that has"),
        (["box-scene", "x.png"], "twinecho: x.png is given without --plot; it must be with it"),
    ],
)
def test_a_picture_of_nothing_is_one_line(arguments, message):
    found = CliRunner().invoke(app, ["check", *arguments])
    assert found.exit_code == 2
    assert found.stderr.splitlines() == [message]


def test_shipped_scenes_have_a_plan():
    for name in catalogue.NAMES:
        if catalogue.study(name).scene is not None:
            assert "scatterers_per_resolution" in CliRunner().invoke(app, ["check", name]).output
