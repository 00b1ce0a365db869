"""Echoes at the extremes of what estimators promise to take, each with the delay that was simulated."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from estimators import FixedWindow, extremes
from sim import EchoPair, Sonar, speckle_pair
from sim.band import Real
from sim.coherence import noise_coherence

LOOKS = 33
"""Samples of a record and of the window, which holds all of it, where a case does not say another."""

WHOLE = FixedWindow(1, LOOKS)

SAMPLES = 64
"""Samples of a longer record, 4/3 in `1 / B`."""


@dataclass(frozen=True, eq=False)
class Echoes:
    """Echoes of one case, in independent rows.

    Attributes
    ----------
    pair
        The echoes.
    delay
        That was simulated [s], one for each row.
    window
        Over which to average.
    column
        The sample of each row that is looked at.
    alike
        Echoes that differ by powers of two alone, of which estimates must be the same bits.
    exact
        Whether nothing but the method is between the estimate and the delay.
    coherence
        Of both receivers, where theory needs it.
    modulo
        Whether the echoes tell the delay modulo a wrap only, as those of no bandwidth do.
    """

    pair: EchoPair
    delay: Real
    window: FixedWindow = WHOLE
    column: int = 0
    alike: EchoPair | None = None
    exact: bool = False
    coherence: float | None = None
    modulo: bool = False


@dataclass(frozen=True)
class Setting:
    """What all cases share: the sonar, the number of rows, the largest delay that a method looks for [s]."""

    sonar: Sonar
    rows: int
    reach: Callable[[Sonar], float]

    def speckle(self, coherence: float, delay: Any, rng: np.random.Generator, **other: Any) -> EchoPair:
        """Speckle of the sonar's band, one record of `LOOKS` samples a row."""
        given = {"samples": LOOKS, "oversampling": 1.0, "bandwidth": self.sonar.bandwidth, **other}
        return speckle_pair(
            (self.rows, given["samples"]),
            coherence=coherence,
            delay=delay,
            centre_frequency=self.sonar.centre_frequency,
            bandwidth=given["bandwidth"],
            sample_rate=given["oversampling"] * given["bandwidth"],
            rng=rng,
        )

    def longer(self, coherence: float, delay: Any, rng: np.random.Generator) -> EchoPair:
        """Speckle of `SAMPLES` samples a row, 4/3 in `1 / B`."""
        return self.speckle(coherence, delay, rng, samples=SAMPLES, oversampling=4 / 3)

    def delays(self, rng: np.random.Generator) -> Real:
        """A delay for each row, even within half a wrap of zero [s]."""
        drawn: Real = rng.uniform(-0.5, 0.5, self.rows) * self.sonar.wrap
        return drawn


def at_snr(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Two equally noisy receivers [dB]."""
    gamma, delay = float(noise_coherence(value)), setting.delays(rng)
    return Echoes(setting.speckle(gamma, delay, rng), delay, coherence=gamma)


def at_coherence(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """One coherence over the band."""
    delay = setting.delays(rng)
    return Echoes(setting.speckle(value, delay, rng), delay, coherence=value, exact=value == 1)


def of_window(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Windows of so many samples, up to the whole record, at 20 dB."""
    delay = setting.delays(rng)
    pair = setting.longer(float(noise_coherence(20.0)), delay, rng)
    return Echoes(pair, delay, FixedWindow(1, int(value)), SAMPLES // 2)


def of_looks(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Records and windows of so many looks, at 20 dB."""
    delay, samples = setting.delays(rng), int(value)
    pair = setting.speckle(float(noise_coherence(20.0)), delay, rng, samples=samples)
    return Echoes(pair, delay, FixedWindow(1, samples))


def of_bandwidth(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Relative bandwidths, at 20 dB."""
    # Within what the split spectrum can tell, 0.75 / B.
    delay = setting.delays(rng) * min(1.0, 1.5 / value)
    bandwidth = value * setting.sonar.centre_frequency
    return Echoes(setting.speckle(float(noise_coherence(20.0)), delay, rng, bandwidth=bandwidth), delay)


def of_delay(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Delays up to the border of what the method looks for, without noise."""
    delay = np.full(setting.rows, value * setting.reach(setting.sonar))
    return Echoes(setting.longer(1.0, delay, rng), delay, column=SAMPLES // 2, exact=True)


def of_half_a_wrap(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Delays next to half a wrap [wraps], without noise."""
    delay = np.full(setting.rows, value * setting.sonar.wrap)
    return Echoes(setting.longer(1.0, delay, rng), delay, column=SAMPLES // 2, exact=True)


def of_amplitude(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Both receivers next to a power of ten, at 20 dB."""
    return _scaled(value, value, setting, rng, np.complex128)


def of_amplitudes_apart(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """The secondary next to a power of ten, the primary as far the other way."""
    return _scaled(1 / value, value, setting, rng, np.complex128)


def in_single_precision(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Both receivers next to a power of ten, in single precision."""
    return _scaled(value, value, setting, rng, np.complex64)


def _scaled(first: float, second: float, setting: Setting, rng: np.random.Generator, kind: type) -> Echoes:
    delay = setting.delays(rng)
    pair = _of_kind(setting.longer(float(noise_coherence(20.0)), delay, rng), kind)
    powers = [kind(2.0 ** np.round(np.log2(amplitude))) for amplitude in (first, second)]
    scaled = replace(pair, primary=powers[0] * pair.primary, secondary=powers[1] * pair.secondary)
    return Echoes(scaled, delay, column=SAMPLES // 2, alike=pair)


def of_denormals(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Speckle of so many times the smallest number above zero, rounded to whole ones."""
    return _of_whole(value, setting, rng, np.complex128)


def of_single_denormals(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """The same in single precision."""
    return _of_whole(value, setting, rng, np.complex64)


def _of_whole(value: float, setting: Setting, rng: np.random.Generator, kind: type) -> Echoes:
    delay = setting.delays(rng)
    pair = setting.longer(1.0, delay, rng)
    part = np.float32 if kind is np.complex64 else np.float64
    least: Any = part(np.finfo(part).smallest_subnormal)

    def whole(series: Any) -> Any:
        numbers: Any = np.round(value * np.stack([series.real, series.imag], axis=-1)).astype(part)
        return (numbers * least).view(kind)[..., 0]

    tiny = replace(pair, primary=whole(pair.primary), secondary=whole(pair.secondary))
    return Echoes(tiny, delay, column=SAMPLES // 2)


def of_silence(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Nothing in the primary (1), the secondary (2) or both (3)."""
    delay = setting.delays(rng)
    pair = setting.longer(1.0, delay, rng)
    silent = {name: 0 * getattr(pair, name) for bit, name in ((1, "primary"), (2, "secondary")) if int(value) & bit}
    return Echoes(replace(pair, **silent), delay, column=SAMPLES // 2)


def of_constants(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """The same number everywhere, the secondary turned by the phase of a delay [wraps]."""
    delay = np.full(setting.rows, value * setting.sonar.wrap)
    pair = setting.longer(1.0, 0.0, rng)
    one = np.ones_like(pair.primary)
    constant = replace(pair, primary=one, secondary=one * np.exp(-2j * np.pi * value))
    return Echoes(constant, delay, column=SAMPLES // 2, modulo=True)


def beside_a_bright_echo(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """An echo so many times as strong as the speckle, of its delay and 20 samples from the pixel."""
    delay = setting.delays(rng)
    pair = setting.longer(float(noise_coherence(20.0)), delay, rng)
    # Speckle of one point: all lines of the band in phase there.
    place = (SAMPLES // 2 - 20) / pair.sample_rate
    frequencies = np.arange(-23, 24) / pair.grid.period
    lag = pair.grid.times - place
    first = np.exp(2j * np.pi * frequencies[:, None] * lag).mean(axis=0)
    delayed = np.exp(-2j * np.pi * (frequencies + pair.centre_frequency) * delay[:, None])
    second = delayed @ np.exp(2j * np.pi * frequencies[:, None] * lag) / len(frequencies)
    bright = replace(pair, primary=pair.primary + value * first, secondary=pair.secondary + value * second)
    return Echoes(bright, delay, column=SAMPLES // 2)


def beside_a_spike(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """A single sample of the secondary so many times as strong, 20 samples from the pixel, outside its window."""
    return _spiked(value, 20, setting, rng)


def within_a_spike(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """The same within the window."""
    return _spiked(value, 3, setting, rng)


def _spiked(value: float, distance: int, setting: Setting, rng: np.random.Generator) -> Echoes:
    delay = setting.delays(rng)
    pair = setting.longer(float(noise_coherence(20.0)), delay, rng)
    secondary = pair.secondary.copy()
    secondary[:, SAMPLES // 2 - distance] *= value
    return Echoes(replace(pair, secondary=secondary), delay, column=SAMPLES // 2)


def with_gaps(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """NaN and infinite samples in such a share of rows, or in all of a record, at 20 dB."""
    delay = setting.delays(rng)
    pair = setting.longer(float(noise_coherence(20.0)), delay, rng)
    bad = rng.uniform(size=pair.shape) < value
    broken = np.where(rng.uniform(size=pair.shape) < 0.5, complex(0.0, np.nan), complex(-np.inf, 1.0))
    gaps = EchoPair.with_gaps(
        np.where(bad, broken, pair.primary),
        np.where(bad[::-1], broken, pair.secondary),
        pair.sample_rate,
        pair.centre_frequency,
        pair.bandwidth,
    )
    return Echoes(gaps, delay, FixedWindow(1, 9), SAMPLES // 2)


def beside_silence(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """Zeros in both receivers from so many samples after the pixel on, at 20 dB: a record that was padded."""
    delay = setting.delays(rng)
    pair = setting.longer(float(noise_coherence(20.0)), delay, rng)
    heard = np.arange(SAMPLES) < SAMPLES // 2 + value
    padded = replace(pair, primary=pair.primary * heard, secondary=pair.secondary * heard, circular=False)
    return Echoes(padded, delay, FixedWindow(1, 9), SAMPLES // 2)


def beside_bright_rows(value: float, setting: Setting, rng: np.random.Generator) -> Echoes:
    """All rows but the first so many times as strong as that, at 20 dB."""
    delay = setting.delays(rng)
    pair = setting.longer(float(noise_coherence(20.0)), delay, rng)
    strength = np.where(np.arange(setting.rows) > 0, value, 1.0)[:, None]
    dark = replace(pair, primary=pair.primary * strength, secondary=pair.secondary * strength)
    return Echoes(dark, delay, FixedWindow(1, 9), SAMPLES // 2)


def _of_kind(pair: EchoPair, kind: type) -> EchoPair:
    return replace(pair, primary=pair.primary.astype(kind), secondary=pair.secondary.astype(kind))


def in_single(echoes: Echoes) -> Echoes | None:
    """The same echoes in single precision; None where it cannot hold them, or they are."""
    pair = echoes.pair
    largest = max(float(np.abs(series.view(float)).max()) for series in (pair.primary, pair.secondary))
    if pair.primary.dtype == np.complex64 or not 1e-30 < largest < 1e30:
        return None
    return replace(echoes, pair=_of_kind(pair, np.complex64))


_LOW, _HIGH = extremes.SNR
_NARROW, _WIDE = extremes.RELATIVE_BANDWIDTH
_FAINT, _LOUD = extremes.AMPLITUDE
_FAINT_SINGLE, _LOUD_SINGLE = extremes.SINGLE_AMPLITUDE

Make = Callable[[float, Setting, np.random.Generator], Echoes]

CASES: Mapping[str, tuple[Make, tuple[float, ...]]] = MappingProxyType(
    {
        "SNR [dB]": (at_snr, (_LOW, -30.0, -10.0, 0.0, 10.0, 20.0, 40.0, 60.0, 90.0, _HIGH)),
        "coherence": (at_coherence, (0.0, 1e-150, 0.5, 1 - 2.0**-53, 1.0)),
        "window [samples]": (of_window, (1, 2, 3, 9, 33, SAMPLES)),
        "looks": (of_looks, (1, 2, 3, 5, 33)),
        "relative bandwidth": (of_bandwidth, (_NARROW, 0.01, 0.1, 0.3, 0.6, 1.2, _WIDE)),
        "delay [search range]": (of_delay, (-1.0, -0.99, 0.0, 0.5, 0.9, 0.99, 1.0)),
        "delay [wraps]": (of_half_a_wrap, (-0.5, 0.499, 0.5)),
        "amplitude": (of_amplitude, (_FAINT, 1e-75, 1.0, 1e75, _LOUD)),
        "ratio of amplitudes": (of_amplitudes_apart, (_FAINT, _LOUD)),
        "amplitude, single": (in_single_precision, (_FAINT_SINGLE, 1e-15, 1.0, 1e15, _LOUD_SINGLE)),
        "denormals": (of_denormals, (1, 10, 1e4)),
        "denormals, single": (of_single_denormals, (1, 10, 1e4)),
        "silent receiver": (of_silence, (1, 2, 3)),
        "constant [wraps]": (of_constants, (-0.25, 0.0, 0.5)),
        "bright echo beside": (beside_a_bright_echo, (1e2, 1e6, 1e12, 1e18)),
        "spike beside": (beside_a_spike, (1e2, 1e6, 1e12, _LOUD)),
        "spike within": (within_a_spike, (1e2, 1e6, 1e12, _LOUD)),
        "share not finite": (with_gaps, (0.01, 0.1, 1.0)),
        "silence after [samples]": (beside_silence, (-20, -8, -3, 0, 3, 6, 8, 12)),
        "rows dark beside one": (beside_bright_rows, (1e-12, 1e-70, 1e-80, 1e-90, _FAINT)),
    }
)
"""How each case is made, and its values."""
