import dataclasses

import numpy as np
import pytest

from sim import SEDIMENTS, ElasticBed, FluidBed, Sediment


def test_catalogue_holds_the_handbook(oracle):
    table = oracle("sediments").set_index("sediment")
    assert list(SEDIMENTS) == list(table.index)
    for name, row in table.iterrows():
        fluid = SEDIMENTS[name].fluid
        found = [
            fluid.grain_size_phi,
            fluid.density_ratio,
            fluid.sound_speed_ratio,
            fluid.loss_parameter,
            fluid.volume_parameter,
            fluid.spectral_exponent,
            fluid.spectral_strength_cm4,
        ]
        assert found == row.tolist()


def test_catalogue_holds_the_elastic_sets(oracle):
    table = oracle("sediments_elastic").set_index("sediment")
    assert sum(sediment.elastic is not None for sediment in SEDIMENTS.values()) == len(table) == 8
    for name, row in table.iterrows():
        elastic = SEDIMENTS[name].elastic
        assert [getattr(elastic, field) for field in table.columns] == row.tolist()
        fluctuations = (1, 3, 4) if "rock" in name else (1, 0, 0)
        found = (
            elastic.density_fluctuation,
            elastic.compressional_speed_fluctuation,
            elastic.shear_speed_fluctuation,
        )
        assert found == fluctuations


def test_both_sets_of_sand_agree():
    # Strengths are rounded to three or four digits in the elastic table.
    for name in ("coarse sand", "medium sand", "fine sand", "silt"):
        derived, elastic = ElasticBed.of_fluid(SEDIMENTS[name].fluid), SEDIMENTS[name].elastic
        assert derived.spectral_strength_si == pytest.approx(elastic.spectral_strength_si, rel=0.005)
        # The elastic set of silt goes with sigma2 = 0.001.
        assert derived.volume_strength == pytest.approx(elastic.volume_strength, rel=0.005)


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        ("sand", "medium sand, sand"),
        ("gravel", "cobble, gravel, pebble"),
        ("Coarse_Sand", "coarse sand, gravelly sand"),
        ("gravelly-sand", "coarse sand, gravelly sand"),
        (" SAND, coarse ", "coarse sand, gravelly sand"),
        ("cobbles", "cobble, gravel, pebble"),
        ("silt", "silt / sandy mud"),
        ("sandy mud", "silt / sandy mud"),
        ("sand-silt-clay", "medium silt, sand-silt-clay"),
        ("silty clay", "silty clay"),
        ("clayey silt", "fine silt, clayey silt"),
    ],
)
def test_look_up_is_forgiving(asked, found):
    assert SEDIMENTS[asked].name == found
    assert asked in SEDIMENTS


def test_every_part_of_a_name_finds_its_sediment():
    for name, sediment in SEDIMENTS.items():
        for part in name.replace("/", ",").split(","):
            assert SEDIMENTS[part] is sediment


@pytest.mark.parametrize("kind", [KeyError, ValueError])
def test_unknown_name_lists_close_ones(kind):
    with pytest.raises(kind) as caught:
        SEDIMENTS["corse sand"]
    assert str(caught.value).startswith("sediment is 'corse sand'; the closest names are coarse sand, ")
    assert "xyzzy" not in SEDIMENTS
    with pytest.raises(kind, match=r"^sediment is 'xyzzy'; it must be one of rough rock, rock, cobble, gravel, .*"):
        SEDIMENTS["xyzzy"]


def test_grain_size_gives_the_table_of_the_handbook():
    """From -1 to 9 phi the table was made by the regressions and then rounded."""
    for sediment in SEDIMENTS.values():
        phi = sediment.fluid.grain_size_phi
        if phi < -1:
            continue
        found = Sediment.from_grain_size(phi).fluid
        assert found.density_ratio == pytest.approx(sediment.fluid.density_ratio, abs=5.1e-4)
        assert found.sound_speed_ratio == pytest.approx(sediment.fluid.sound_speed_ratio, abs=1e-4)
        assert found.loss_parameter == pytest.approx(sediment.fluid.loss_parameter, abs=5.1e-6)
        assert found.volume_parameter == sediment.fluid.volume_parameter
        assert found.spectral_strength_cm4 == pytest.approx(sediment.fluid.spectral_strength_cm4, abs=5.1e-7)


def test_adjusting():
    sand = SEDIMENTS["sand"]
    other = sand.adjusted(level_offset=3.0, density_ratio=2.0, volume_parameter=0.001, shear_loss=0.5)
    assert (other.level_offset, other.fluid.density_ratio, other.solid.density_ratio) == (3.0, 2.0, 2.0)
    assert (other.fluid.volume_parameter, other.solid.shear_loss) == (0.001, 0.5)
    assert other.adjusted(level_offset=0.0, density_ratio=1.845, volume_parameter=0.002, shear_loss=1.0) == sand
    assert dataclasses.replace(sand, level_offset=-2.0).level_offset == -2.0
    clay = SEDIMENTS["clay"].adjusted(spectral_strength_cm4=0.001)
    assert clay.solid.spectral_strength_si == pytest.approx(0.001 * 1e-8 * 0.01**-3.25)


GOOD = vars(SEDIMENTS["clay"].fluid)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: FluidBed(**{**GOOD, "density_ratio": 0.0}), "density_ratio is 0; it must be above 0"),
        (lambda: FluidBed(**{**GOOD, "volume_parameter": -1.0}), "volume_parameter is -1; it must not be below 0"),
        (
            lambda: FluidBed(**{**GOOD, "spectral_exponent": 4.0}),
            "spectral_exponent is 4; it must lie between 2.1 and 3.99",
        ),
        (lambda: SEDIMENTS["rock"].adjusted(shear_loss=0.0), "shear_loss is 0; it must be above 0"),
        (
            lambda: SEDIMENTS["rock"].adjusted(level_offset=np.nan),
            "level_offset is nan; it must be finite",
        ),
        (
            lambda: SEDIMENTS["clay"].adjusted(shear_loss=0.1),
            "clay has no parameter 'shear_loss'; it has density_ratio, grain_size_phi, level_offset, .*",
        ),
        (lambda: Sediment.from_grain_size(10.0), "grain_size is 10 phi; it must lie between -1 and 9 phi"),
    ],
)
def test_bad_input(build, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        build()
