"""Scenes, as a study asks for them."""

from functools import lru_cache
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from estimators import DelayEstimate
from estimators.moving_sum import window_sum
from estimators.windows import Window
from sim import EchoPair, Plan, Scene, Sonar, plan, simulate
from sim.band import Real
from sim.scattering import Model
from studies.quantity import Decibels, Metres
from studies.scene_sections import FeatureSection, PatchSection, PlanSection, TargetSection
from studies.section import Section
from studies.world import Reading


class Swath(Section):
    """A scene over which a sonar passes; a trial is a row along track, of speckle and noise of its own.

    Every block passes over the same stretch of seabed, from along-track place 0 on.

    Parameters
    ----------
    ground_range
        Near and far end of the floor [m].
    features
        What shapes it.
    snr
        Signal-to-noise ratio of the flat floor in either receiver [dB]; inf for no noise. Only without a sediment.
    sediment, scattering, patches, targets, speckle_shape
        As of `sim.Scene`, sediments by name. With a sediment the levels come from the sonar equation.
    row_spacing
        Distance of rows [m]; the along-track resolution, where they are independent, unless given.
    plan
        What is decided of the simulation, whatever the scene requires.
    """

    ground_range: tuple[Metres, Metres]
    features: tuple[FeatureSection, ...] = ()
    snr: Annotated[Decibels, Field(gt=-200)] = float("inf")
    sediment: str | None = None
    scattering: Model = "small-slope"
    patches: tuple[PatchSection, ...] = ()
    targets: tuple[TargetSection, ...] = ()
    speckle_shape: Annotated[float, Field(gt=0)] = float("inf")
    row_spacing: Annotated[Metres, Field(gt=0)] | None = None
    plan: PlanSection = PlanSection()

    @model_validator(mode="after")
    def _stands(self) -> Self:
        level = self.plan.level
        if self.sediment is not None and "snr" in self.model_fields_set:
            raise ValueError(f"snr is {self.snr:g} dB beside a sediment, whose levels follow; it must be one of them")
        if level is not None and (level == "even") != (self.sediment is None):
            allowed = "even without a sediment" if self.sediment is None else "flat or local with a sediment"
            raise ValueError(f"plan.level is {level!r}; it must be {allowed}")
        self.scene()
        return self

    def scene(self) -> Scene:
        """As the simulator knows it."""
        return _scene(self)

    def required(self, sonar: Sonar, rows: int) -> Plan:
        """How some of its rows are simulated.

        Raises
        ------
        ValueError
            Where the sonar is not above the scene.
        """
        return plan(
            self.scene(),
            sonar,
            snr=self._snr,
            rows=rows,
            row_spacing=self.row_spacing,
            tolerance=self.plan.tolerance,
            **self.plan.chosen,
        )

    @property
    def _snr(self) -> float | None:
        return self.snr if np.isfinite(self.snr) else None

    @property
    def true_coherence(self) -> float:
        """Coherence that the noise leaves of the flat floor; of a sediment, where it depends on range, NaN."""
        return 1 / (1 + 10 ** (-self.snr / 10)) if self.sediment is None else np.nan

    @property
    def snr_db(self) -> float:
        """Signal-to-noise ratio of the flat floor [dB]; of a sediment, where it depends on range, NaN."""
        return self.snr if self.sediment is None else np.nan

    def record(self) -> tuple[int, int]:
        """No window holds a whole scene."""
        raise ValueError("a window is 'record'; in a scene it must be [rows, samples]")

    def check(self, sonar: Sonar) -> None:
        """ValueError unless the sonar is above the scene, and hears one part of it at a time where a warp is given."""
        self.required(sonar, 1)
        if self.plan.delays == "warp":
            self.simulate(sonar, 1, np.random.default_rng(0))

    def shape(self, sonar: Sonar, trials: int) -> tuple[int, int]:
        """One row a trial, as long as the scene is heard."""
        return trials, self.required(sonar, 1).grid.samples

    def simulate(self, sonar: Sonar, trials: int, rng: np.random.Generator) -> EchoPair:
        """One row a trial, registered to the floor."""
        return simulate(self.scene(), sonar, rng=rng, snr=self._snr, rows=trials, required=self.required(sonar, trials))

    def read(self, pair: EchoPair, window: Window, estimate: DelayEstimate) -> list[Reading]:
        """Errors outside layover, and in it; there, against the nearest of the parts that are heard at once.

        A cluster is a row: the rows read are as far apart as a window has rows, and further by the along-track
        resolution where neighbours are alike, so that what one window holds and the next is independent but for side
        lobes of the resolution, 5 % of power at the most.
        """
        truth = pair.truth
        assert truth is not None
        assert truth.branches is not None
        assert truth.layover is not None
        rows = _apart(pair, window)
        chosen = rows if np.ndim(truth.delay) == 2 else slice(None)
        delay, true = estimate.delay[rows], np.atleast_2d(truth.delay)[chosen]
        readings = [_reading("outside", delay - true, rows, np.atleast_2d(clear(pair, window))[chosen])]
        heard = np.isfinite(truth.branches).any(axis=0)
        layover = np.atleast_2d(truth.layover & heard)[chosen]
        if layover.any():
            branches = truth.branches.reshape(len(truth.branches), -1, pair.shape[1])[:, chosen]
            readings.append(_reading("layover", _nearest(delay, branches), rows, layover))
        return readings

    def traces(self, pair: EchoPair) -> dict[str, Real]:
        """Slant range [m], and the true delays of all parts heard in the first row [s]."""
        truth, geometry = pair.truth, pair.geometry
        assert truth is not None
        assert truth.branches is not None
        assert geometry is not None
        branches = truth.branches if truth.branches.ndim == 2 else truth.branches[:, 0]
        return {"slant range": pair.grid.times * geometry.sonar.sound_speed / 2, "truth": branches}


@lru_cache(maxsize=8)
def _scene(section: Swath) -> Scene:
    """The scene of a section, whose random relief is made once."""
    return Scene(
        ground_range=section.ground_range,
        features=[feature.made() for feature in section.features],
        sediment=section.sediment,
        scattering=section.scattering,
        patches=[patch.made() for patch in section.patches],
        targets=[target.made() for target in section.targets],
        speckle_shape=section.speckle_shape,
    )


def _apart(pair: EchoPair, window: Window) -> slice:
    """Rows whose windows lie within the pair and apart from each other; the first whose window might, at the least."""
    most = window.extent[0]
    first, beyond = most // 2, pair.shape[0] - (most - 1) // 2
    return slice(first, max(beyond, first + 1), most + _cell_rows(pair))


def _cell_rows(pair: EchoPair) -> int:
    """Rows within the along-track resolution; none where rows are independent."""
    return 0 if pair.row_looks == 1 else int(np.ceil(1 / pair.row_looks))


def _reading(region: str, errors: Real, rows: slice, counted: NDArray[np.bool_]) -> Reading:
    """A reading of the samples that count in some row; `counted` has shape (row or 1, time)."""
    samples = np.asarray(counted.any(axis=0))
    return Reading(region, errors[:, samples], rows, samples, counted[:, samples])


def _nearest(delay: Real, branches: Real) -> Real:
    """Errors against the nearest of the branches, shape (branch, row or 1, time); NaN where none is heard."""
    nearest = np.full(delay.shape, np.nan)
    distance = np.full(delay.shape, np.inf)
    for branch in branches:
        nearer = np.abs(delay - branch) < distance
        nearest = np.where(nearer, delay - branch, nearest)
        distance = np.where(nearer, np.abs(delay - branch), distance)
    return nearest


def clear(pair: EchoPair, window: Window) -> NDArray[np.bool_]:
    """Samples whose window, and a resolution cell to either side of it, holds neither shadow nor layover.

    Of the shape of the true delay: (time,) or (rows, time).
    """
    truth = pair.truth
    assert truth is not None
    rows, samples = window.extent
    reach = min(samples + 2 * int(np.ceil(pair.sample_rate / pair.bandwidth)), pair.shape[1])
    unseen = np.atleast_2d(np.isnan(truth.delay)).astype(float)
    within = rows + 2 * _cell_rows(pair) if len(unseen) > 1 else 1
    seen = window_sum(unseen, within, reach, circular=True) == 0
    return np.broadcast_to(seen, unseen.shape).reshape(truth.delay.shape)
