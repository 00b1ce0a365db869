"""Scenes, as a study asks for them."""

from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from estimators import DelayEstimate
from estimators.moving_sum import window_sum
from estimators.windows import Window
from sim import Box, EchoPair, Feature, Scene, Sonar, Wedge, plan, simulate
from sim.band import Real
from studies.quantity import Decibels, Metres
from studies.section import Section
from studies.world import Reading


class FeatureSection(Section):
    """Something that stands on the floor: its kind, and start, width and height [m]."""

    kind: Literal["box", "wedge"]
    start: Metres
    width: Metres
    height: Metres

    @property
    def feature(self) -> Feature:
        """As the simulator knows it."""
        make = Box if self.kind == "box" else Wedge
        return make(self.start, self.width, self.height)


class Swath(Section):
    """A scene over which a sonar passes; a trial is a row along track, of speckle and noise of its own.

    Parameters
    ----------
    ground_range
        Near and far end of the floor [m].
    features
        What stands on it.
    snr
        Signal-to-noise ratio of the flat floor in either receiver [dB]; inf for no noise.
    """

    ground_range: tuple[Metres, Metres]
    features: tuple[FeatureSection, ...] = ()
    snr: Annotated[Decibels, Field(gt=-200)] = float("inf")

    @model_validator(mode="after")
    def _stands(self) -> Self:
        self.scene()
        return self

    def scene(self) -> Scene:
        """As the simulator knows it."""
        return Scene(self.ground_range, tuple(section.feature for section in self.features))

    @property
    def true_coherence(self) -> float:
        """Coherence that the noise leaves of the flat floor."""
        return 1 / (1 + 10 ** (-self.snr / 10))

    @property
    def snr_db(self) -> float:
        """Signal-to-noise ratio of the flat floor [dB]."""
        return self.snr

    def record(self) -> tuple[int, int]:
        """No window holds a whole scene."""
        raise ValueError("a window is 'record'; in a scene it must be [rows, samples]")

    def check(self, sonar: Sonar) -> None:
        """ValueError unless the sonar is above the scene."""
        plan(self.scene(), sonar)

    def shape(self, sonar: Sonar, trials: int) -> tuple[int, int]:
        """One row a trial, as long as the scene is heard."""
        return trials, plan(self.scene(), sonar).grid.samples

    def simulate(self, sonar: Sonar, trials: int, rng: np.random.Generator) -> EchoPair:
        """One row a trial, registered to the floor."""
        snr = self.snr if np.isfinite(self.snr) else None
        return simulate(self.scene(), sonar, rng=rng, snr=snr, rows=trials)

    def read(self, pair: EchoPair, window: Window, estimate: DelayEstimate) -> list[Reading]:
        """Errors outside layover, and in it; there, against the nearest of the parts that are heard at once."""
        truth = pair.truth
        assert truth is not None
        assert truth.branches is not None
        assert truth.layover is not None
        # Rows whose windows do not overlap are independent.
        most = window.extent[0]
        rows = slice(most // 2, None, most)
        delay, outside = estimate.delay[rows], clear(pair, window)
        readings = [Reading("outside", (delay - truth.delay)[:, outside], rows, outside)]
        layover = truth.layover & np.isfinite(truth.branches).any(axis=0)
        if layover.any():
            deviations = delay[None][..., layover] - truth.branches[:, None, layover]
            distance = np.where(np.isnan(deviations), np.inf, np.abs(deviations))
            nearest = np.take_along_axis(deviations, distance.argmin(axis=0)[None], axis=0)[0]
            readings.append(Reading("layover", nearest, rows, layover))
        return readings

    def traces(self, pair: EchoPair) -> dict[str, Real]:
        """Slant range [m], and the true delays of all parts heard [s]."""
        truth, geometry = pair.truth, pair.geometry
        assert truth is not None
        assert truth.branches is not None
        assert geometry is not None
        return {"slant range": pair.grid.times * geometry.sonar.sound_speed / 2, "truth": truth.branches}


def clear(pair: EchoPair, window: Window) -> NDArray[np.bool_]:
    """Samples whose window, and a resolution cell to either side of it, holds neither shadow nor layover."""
    truth = pair.truth
    assert truth is not None
    reach = window.extent[1] + 2 * int(np.ceil(pair.sample_rate / pair.bandwidth))
    unseen = np.isnan(truth.delay).astype(float)[None]
    seen = window_sum(unseen, 1, min(reach, unseen.size), circular=True)[0] == 0
    return np.broadcast_to(seen, truth.delay.shape)
