"""The interferogram's pass over whole images, against adding the pixels of each window."""

import numpy as np
import pytest
import window_twin
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import interference
from estimators.interference import interferogram, interferogram_with_energy

few = settings(max_examples=40, deadline=None)


def images(shape, rng, kind=np.complex128):
    # Whole numbers, so that every order of adding gives the same.
    pair = rng.integers(-99, 99, (2, *shape)) + 1j * rng.integers(-99, 99, (2, *shape))
    return pair.astype(kind)


@st.composite
def cases(draw):
    rows, times = draw(st.integers(1, 12)), draw(st.integers(1, 40))
    sizes = draw(st.integers(1, rows)), draw(st.just(times) | st.integers(1, times))
    return rows, times, *sizes, draw(st.booleans()), draw(st.integers(0, 2**32 - 1))


@few
@given(cases(), st.sampled_from([np.complex128, np.complex64]))
def test_it_is_the_sum_over_the_window_with_its_coherence(case, kind):
    *shape, rows, samples, circular, seed = case
    primary, secondary = images(shape, np.random.default_rng(seed), kind)
    product, coherence = interferogram(primary, secondary, rows, samples, circular=circular)
    twin, share = window_twin.interferogram(primary, secondary, rows, samples, circular)
    assert (product.dtype, coherence.dtype) == (primary.dtype, primary.real.dtype)
    np.testing.assert_array_equal(product, twin.astype(kind))
    np.testing.assert_allclose(coherence, share, rtol=4 * np.finfo(kind).eps)
    scaled, energy = interferogram_with_energy(primary, secondary, rows, samples, circular=circular)
    scaled, energy = np.broadcast_arrays(scaled, energy, primary)[:2]
    np.testing.assert_allclose(np.abs(scaled), share * energy, rtol=1e-14)
    np.testing.assert_allclose(scaled * np.abs(twin), twin * np.abs(scaled), rtol=1e-14)


@pytest.mark.parametrize("circular", [True, False])
def test_neither_strips_nor_blocks_nor_threads_show(circular):
    primary, secondary = images((600, 2500), np.random.default_rng(3))
    one, two = (interferogram(primary, secondary, 5, 8, circular=circular, threads=n) for n in (1, 2))
    for once, again in zip(one, two, strict=True):
        np.testing.assert_array_equal(once, again)
    # Around the edges of blocks of rows and of strips in time.
    for rows in (slice(240, 280), slice(500, 530)):
        part = window_twin.window_sum((primary.conj() * secondary)[rows, 2000:2100], 5, 8, False)
        np.testing.assert_array_equal(one[0][rows, 2000:2100][5:-5, 8:-8], part[5:-5, 8:-8])


@pytest.mark.parametrize(("rows", "samples"), [(1, 1), (1, 9), (9, 1), (9, 9), (30, 30)])
@pytest.mark.parametrize("kind", [np.complex128, np.complex64])
def test_beside_a_pixel_80_db_brighter_the_phase_keeps_its_digits(rows, samples, kind):
    rng = np.random.default_rng(7)
    quiet = (rng.normal(size=(2, 100, 400)) + 1j * rng.normal(size=(2, 100, 400))).astype(kind)
    quiet[1] = 0.9 * quiet[0] + 0.4 * quiet[1]
    quiet[:, 40:45, 200:203] *= 1e4
    product, _ = interferogram(*quiet, rows, samples, circular=False)
    twin, _ = window_twin.interferogram(*quiet, rows, samples, False)
    error = np.angle(product * twin.conj())
    assert np.abs(error).max() < 1e-6


def test_where_there_is_no_echo_there_is_no_coherence():
    rng = np.random.default_rng(5)
    primary, secondary = rng.normal(size=(2, 300, 500)) + 1j * rng.normal(size=(2, 300, 500))
    primary[:, 100:300] = secondary[:, 200:400] = 0
    primary[100:150], secondary[120:280] = 0, 0
    secondary[50, 50] = 1e6
    product, coherence = interferogram(primary, secondary, 9, 9, circular=True)
    _, energy = interferogram_with_energy(primary, secondary, 9, 9, circular=True)
    energies = [window_twin.window_sum(np.abs(image) ** 2, 9, 9, True) for image in (primary, secondary)]
    dark = (energies[0] == 0) | (energies[1] == 0)
    # As documented for this size.
    bright = (energies[0] > 3e-12 * energies[0].max()) & (energies[1] > 3e-12 * energies[1].max())
    assert 0.3 < dark.mean() < 0.9
    for values in (product, coherence, energy):
        np.testing.assert_array_equal(values[dark], 0)
    assert bright.mean() > 0.1
    assert np.all(energy[bright] > 0)
    assert np.all(coherence <= 1)


def test_windows_of_silence_are_zero():
    silence = np.zeros((20, 30), dtype=np.complex64)
    for values in interferogram(silence, silence, 3, 5, circular=False):
        np.testing.assert_array_equal(values, 0)


@pytest.mark.parametrize("darker", [1e-70, 1e-76, 1e-80, 1e-81, 1e-90, 1e-200])
def test_blocks_too_dark_for_squares_beside_others_count_as_empty(darker):
    rng = np.random.default_rng(8)
    primary, secondary = rng.normal(size=(2, 1100, 64)) + 1j * rng.normal(size=(2, 1100, 64))
    _, plain = interferogram(primary, secondary, 3, 3, circular=False)
    strength = np.where(np.arange(1100) < 600, 1.0, darker)[:, None]
    _, coherence = interferogram(strength * primary, strength * secondary, 3, 3, circular=False)
    dark = coherence[602:]
    assert np.all((dark == 0) | np.isclose(dark, plain[602:], rtol=1e-9))
    assert darker > 1e-76 or not dark.any()
    np.testing.assert_allclose(coherence[:598], plain[:598], rtol=1e-12)


@pytest.mark.parametrize("exponent", [-150, 150])
def test_numbers_of_any_size_are_taken(exponent):
    rng = np.random.default_rng(2)
    primary, secondary = rng.normal(size=(2, 9, 30)) + 1j * rng.normal(size=(2, 9, 30))
    _, coherence = interferogram(primary, secondary, 3, 5, circular=True)
    _, scaled = interferogram(10.0**exponent * primary, 10.0**exponent * secondary, 3, 5, circular=True)
    np.testing.assert_allclose(scaled, coherence, rtol=1e-12)


def test_single_pixels_of_any_brightness_are_coherent():
    # Products of energies of float32 span twice its range.
    image = np.geomspace(1e-18, 1e18, 60).astype(np.complex64)[None]
    product, coherence = interferogram(image, image, 1, 1, circular=False)
    np.testing.assert_allclose(product, image.conj() * image, rtol=1e-6)
    np.testing.assert_allclose(coherence, 1, rtol=1e-6)


def test_images_are_read_where_they_lie(monkeypatch):
    seen = []
    monkeypatch.setattr(interference, "interfere", lambda p, s, *_: seen.append((p, s)))
    image = np.ones((4, 6), dtype=np.complex64)
    interferogram(image, image, 3, 3, circular=False)
    assert all(np.shares_memory(series, image) for series in seen[0])


@pytest.mark.parametrize(
    ("primary", "secondary", "window", "message"),
    [
        (np.ones((2, 3), complex), np.ones((2, 4), complex), (1, 1), "the images have the shapes"),
        (np.ones(3, complex), np.ones(3, complex), (1, 1), "the images have the shapes"),
        (np.ones((2, 3)), np.ones((2, 3)), (1, 1), "the images are of type float64"),
        (np.ones((2, 3), np.complex64), np.ones((2, 3), complex), (1, 1), "the images are of type complex64"),
        (np.ones((2, 3), complex), np.ones((2, 3), complex), (0, 1), "the window has 0 rows"),
        (np.ones((2, 3), complex), np.ones((2, 3), complex), (1, 4), "the window has 1 rows and 4 samples"),
    ],
)
def test_what_cannot_be_is_told(primary, secondary, window, message):
    with pytest.raises(ValueError, match=message):
        interferogram(primary, secondary, *window, circular=True)
