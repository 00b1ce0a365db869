"""Homogeneous patches of speckle, as a study asks for them."""

from collections.abc import Callable
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from estimators import DelayEstimate, bounds
from estimators.windows import Window
from sim import EchoPair, Sonar, rare_speckle_pair, speckle_pair
from sim.band import Real
from studies.quantity import Decibels, Wraps
from studies.section import Section
from studies.world import Reading

Draw = Callable[..., EchoPair]


class Patch(Section):
    """One coherence and delay everywhere; a trial is a periodic record of a stated number of looks.

    An odd number of looks is as many equal Fourier bins, critically sampled. A band of an even number has no middle
    bin: it lies between two odd ones, its outermost bins are in part outside the band, so that
    `(sum w)^2 / sum w^2` is the number of looks, and the record is sampled about twice as densely.

    Parameters
    ----------
    looks
        Equivalent independent looks in the record, at least 3.
    snr
        Signal-to-noise ratio of either receiver [dB]; inf for none. Gives the coherence `rho / (1 + rho)`.
    coherence
        The coherence itself, 0 to 1; either this or `snr`.
    delay
        The true delay of each trial is drawn evenly within so many wraps to either side of zero.
    sampling
        "direct", or "rare" for trials in which wrap errors are frequent, with weights (`sim.rare_speckle_pair`).
    """

    looks: Annotated[int, Field(ge=3)]
    snr: Decibels | None = None
    coherence: Annotated[float, Field(ge=0, le=1)] | None = None
    delay: Annotated[Wraps, Field(ge=0)] = 0.5
    sampling: Literal["direct", "rare"] = "direct"

    @model_validator(mode="after")
    def _one_level(self) -> Self:
        if (self.snr is None) == (self.coherence is None):
            raise ValueError("snr and coherence are both given or both missing; it must be one of them")
        return self

    @property
    def true_coherence(self) -> float:
        """Coherence of the two series."""
        if self.coherence is not None:
            return self.coherence
        assert self.snr is not None
        return 1 / (1 + 10 ** (-self.snr / 10))

    @property
    def snr_db(self) -> float:
        """Signal-to-noise ratio of either receiver [dB]; that which gives the coherence where that is stated."""
        if self.snr is not None:
            return self.snr
        with np.errstate(divide="ignore"):
            return float(10 * np.log10(bounds.snr_from_coherence(self.true_coherence)))

    @property
    def ranged(self) -> bool:
        """A patch has no range."""
        return False

    @property
    def onward(self) -> bool:
        """All blocks are alike."""
        return False

    def record(self) -> tuple[int, int]:
        """Rows and samples of the window that holds one trial."""
        return 1, self.looks if self.looks % 2 else 2 * self.looks

    def _time_bandwidth(self) -> float:
        """Length of the record times the bandwidth: `x^2 = N (N - 1 + (x - N + 1)^2 / 2)` for an even number N."""
        n = self.looks
        if n % 2:
            return n
        whole = n - 1
        root = np.sqrt((n * whole) ** 2 - (2 * n - 4) * n * (whole + whole**2 / 2))
        return float(n * whole - root) / (n - 2)

    def check(self, sonar: Sonar) -> None:
        """Any sonar will do."""

    def shape(self, sonar: Sonar, trials: int) -> tuple[int, int]:
        """One record a trial."""
        return trials, self.record()[1]

    def simulate(self, sonar: Sonar, trials: int, rng: np.random.Generator, first: int = 0) -> EchoPair:
        """Records, one a row."""
        return self.drawn(speckle_pair if self.sampling == "direct" else rare_speckle_pair, sonar, trials, rng)

    def drawn(self, draw: Draw, sonar: Sonar, trials: int, rng: np.random.Generator) -> EchoPair:
        """Records drawn by a function that is called as `sim.speckle_pair` is."""
        return draw(
            self.shape(sonar, trials),
            coherence=self.true_coherence,
            delay=rng.uniform(-self.delay, self.delay, trials) * sonar.wrap,
            centre_frequency=sonar.centre_frequency,
            bandwidth=sonar.bandwidth,
            sample_rate=sonar.bandwidth * self.record()[1] / self._time_bandwidth(),
            rng=rng,
        )

    def read(self, pair: EchoPair, window: Window, estimate: DelayEstimate) -> list[Reading]:
        """Estimates whose windows do not overlap: one a record where the window is the record."""
        assert pair.truth is not None
        apart = slice(None, None, window.extent[1])
        return [Reading("", estimate.delay[:, apart] - pair.truth.delay, slice(None), apart)]

    def traces(self, pair: EchoPair) -> dict[str, Real]:
        """None: all records are alike."""
        return {}

    def trace(self, pair: EchoPair, estimate: DelayEstimate) -> Real:
        """Delays of the first record [s]."""
        delays: Real = estimate.delay[0]
        return delays
