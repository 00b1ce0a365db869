"""What is expected of a swath, without simulation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from estimators import bounds
from estimators.pixels import PAPER_B, Pixels
from sim import SONARS
from studies import predict
from studies.cli import app

SONAR = SONARS["hisas-1032"]
RANGES = np.linspace(40.0, 400.0, 37)


def test_paper_b_at_its_far_end():
    # Theory section 6: 9 x 9 pixels are 32.4 looks, the coherence at 400 m is .187 and one wrap r lambda / D.
    found = predict(SONAR, 400.0, sediment="coarse sand").iloc[0]
    assert found.looks == pytest.approx(32.4)
    assert found.snr_db == pytest.approx(-6.4, abs=0.01)
    assert found.coherence == pytest.approx(0.187, abs=0.001)
    slant = np.hypot(400.0, 42.0)
    assert found.slant_range == pytest.approx(slant)
    assert found.wrap_height == pytest.approx(slant * 1480.0 / 122e3 / 0.3)
    # Equation 3 with gamma = .187 and 39 x 39 pixels gives 39 cm (kappa = 2).
    wide = predict(SONAR, 400.0, coherence=0.187, window=39, kappa=2.0, most_wrap_errors=1.0).iloc[0]
    assert wide.depth_crlb == pytest.approx(0.39, abs=0.01)


def test_best_window_without_a_bound_on_wrap_errors_is_that_of_equation_7():
    # M^2 alpha = kappa sqrt(alpha) / dxi (r c / D) / (2 pi fc) sqrt(1/rho + 1/(2 rho^2)); the exact phase is a little
    # wider than the bound, and the window the next odd number.
    coherence = np.linspace(0.15, 0.95, 17)
    found = predict(SONAR, np.full(17, 300.0), coherence=coherence, most_wrap_errors=1.0)
    rho = coherence / (1 - coherence)
    scale = found.slant_range * 1480.0 / 0.3 / (2 * np.pi * 122e3)
    continuous = np.sqrt(2.0 * np.sqrt(0.4) / 0.02 * scale * np.sqrt(1 / rho + 1 / (2 * rho**2)) / 0.4)
    assert np.all(found.best_window >= continuous - 1e-9)
    assert np.all(found.best_window <= 1.06 * continuous + 2)
    assert np.all(found.best_window % 2 == 1)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.05, 0.999), st.floats(0.5, 4.0), st.floats(1e-6, 0.3), st.floats(45.0, 400.0))
def test_the_best_window_is_the_smallest_that_does(coherence, kappa, most, y):
    options = {"coherence": coherence, "kappa": kappa, "most_wrap_errors": most}
    found = predict(SONAR, y, **options).iloc[0]
    if found.best_window == 0:
        return

    def does(pixels):
        row = predict(SONAR, y, window=int(pixels), **options).iloc[0]
        return pixels * 0.02 >= kappa * row.depth_std and row.wrap_error_rate <= most

    assert does(found.best_window)
    if PAPER_B.looks_in(found.best_window - 2) >= 1:
        assert not does(found.best_window - 2)


def test_columns_are_the_bounds():
    found = predict(SONAR, RANGES, coherence=0.4, looks=20.5)
    np.testing.assert_allclose(found.wrap_error_rate, bounds.wrap_error_probability(20.5, 0.4, 30 / 122))
    # A phase of standard deviation s is a height of s r lambda / (2 pi D).
    std = found.slant_range * SONAR.wavelength / (2 * np.pi * SONAR.baseline) * bounds.multilook_phase_std(20.5, 0.4)
    np.testing.assert_allclose(found.depth_std, std)
    np.testing.assert_allclose(found.snr_db, 10 * np.log10(0.4 / 0.6))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "sediment and coherence are both given or both missing; it must be one of them"),
        ({"coherence": 1.5}, "coherence is 1.5; it must lie between 0 and 1"),
        ({"coherence": 0.5, "looks": 0.5}, "looks is 0.5; it must lie between 1 and 1e\\+09"),
        ({"coherence": 0.5, "window": 0}, "window is 0; it must be a whole number of at least 1"),
        ({"sediment": "snow"}, "sediment is 'snow'; .*"),
        ({"coherence": 0.5, "kappa": -1}, "kappa is -1; it must lie between 0 and 1e\\+06"),
        ({"coherence": 0.5, "pixels": 0}, "looks is 2; it must lie between 0 and 1"),
    ],
)
def test_bad_values_are_named(options, message):
    def call():
        if "pixels" in options:
            options["pixels"] = Pixels(0.02, 0.02, looks=2)
        return predict(SONAR, RANGES, **options)

    with pytest.raises(ValueError, match=f"^{message}$"):
        call()


def test_the_command_writes_a_table_and_a_figure(tmp_path):
    found = CliRunner().invoke(app, ["predict", "--sediment", "silt", "--sediment", "rock", "--out", str(tmp_path)])
    assert found.exit_code == 0, found.output
    for name in ("table.csv", "figure.png"):
        assert str(tmp_path / name) in found.stdout
        assert (tmp_path / name).is_file()
    refused = CliRunner().invoke(app, ["predict", "--sediment", "silt", "--coherence", "0.5", "--out", str(tmp_path)])
    assert refused.exit_code == 2
    assert refused.stderr == "twinecho: coherence and sediment are both given; it must be one of them\n"
