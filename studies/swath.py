"""Scenes, as a study asks for them."""

from functools import lru_cache
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

import sim
from estimators import DelayEstimate
from estimators.windows import Window
from sim import EchoPair, Plan, Scene, SnrProfile, Sonar, plan, simulate
from sim.band import Real
from sim.scattering import Model
from studies.quantity import Decibels, Metres
from studies.scene_readings import Bins, by_kind, over_range
from studies.scene_sections import FeatureSection, PatchSection, PlanSection, TargetSection
from studies.section import Section
from studies.strip_image import Cells
from studies.world import Reading


class Swath(Section):
    """A scene over which a sonar passes; a trial is a row along track, of speckle and noise of its own.

    Every block passes over the same stretch of seabed, from along-track place 0 on, unless an `overlap` is given.

    Parameters
    ----------
    ground_range
        Near and far end of the floor [m].
    features
        What shapes it.
    snr
        Signal-to-noise ratio of the flat floor in either receiver [dB]; inf for no noise. Only without a sediment.
    snr_profile
        The ratio over range instead: points [ground range, dB], as of `sim.SnrProfile`.
    sediment, scattering, patches, targets, speckle_shape
        As of `sim.Scene`, sediments by name. With a sediment the levels come from the sonar equation.
    row_spacing
        Distance of rows [m]; the along-track resolution, where they are independent, unless given.
    sample_spacing
        Distance of samples in slant range [m], as of `sim.plan`.
    overlap
        Where it is given, blocks go on along track where the one before ends, as parts of one scene whose rows do not
        depend on blocks, and each holds so many rows of its neighbours at either end, for the windows of its own rows.
    bins
        Length [m] of the stretches of ground range that errors are read in, a region each; in one region unless given.
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
    snr_profile: Annotated[tuple[tuple[Metres, Decibels], ...], Field(min_length=1)] | None = None
    row_spacing: Annotated[Metres, Field(gt=0)] | None = None
    sample_spacing: Annotated[Metres, Field(gt=0)] | None = None
    overlap: Annotated[int, Field(ge=0)] | None = None
    bins: Annotated[Metres, Field(gt=0)] | None = None
    plan: PlanSection = PlanSection()

    @model_validator(mode="after")
    def _stands(self) -> Self:
        level = self.plan.level
        if self.sediment is not None and "snr" in self.model_fields_set:
            raise ValueError(f"snr is {self.snr:g} dB beside a sediment, whose levels follow; it must be one of them")
        if self.snr_profile is not None and (self.sediment is not None or "snr" in self.model_fields_set):
            raise ValueError("snr_profile is given beside a sediment or snr; it must be one of them")
        if level is not None and (level == "even") != (self.sediment is None):
            allowed = "even without a sediment" if self.sediment is None else "flat or local with a sediment"
            raise ValueError(f"plan.level is {level!r}; it must be {allowed}")
        self.scene()
        self.ratio()
        return self

    def scene(self) -> Scene:
        """As the simulator knows it."""
        return _scene(self)

    def required(self, sonar: Sonar, rows: int, first_row: int = 0) -> Plan:
        """How some of its rows are simulated.

        Raises
        ------
        ValueError
            Where the sonar is not above the scene.
        """
        return plan(
            self.scene(),
            sonar,
            snr=self.ratio(),
            rows=rows,
            first_row=first_row,
            row_spacing=self.row_spacing,
            sample_spacing=self.sample_spacing,
            tolerance=self.plan.tolerance,
            **self.plan.chosen,
        )

    def ratio(self) -> float | SnrProfile | None:
        """Signal-to-noise ratio of the flat floor, as the simulator knows it."""
        if self.snr_profile is not None:
            return SnrProfile(*zip(*self.snr_profile, strict=True))
        return self.snr if np.isfinite(self.snr) else None

    @property
    def _level(self) -> bool:
        """Whether the flat floor has one signal-to-noise ratio at all ranges."""
        return self.sediment is None and self.snr_profile is None

    @property
    def true_coherence(self) -> float:
        """Coherence that the noise leaves of the flat floor; NaN where it depends on range."""
        return 1 / (1 + 10 ** (-self.snr / 10)) if self._level else np.nan

    @property
    def snr_db(self) -> float:
        """Signal-to-noise ratio of the flat floor [dB]; NaN where it depends on range."""
        return self.snr if self._level else np.nan

    def snr_at(self, sonar: Sonar, ground_range: Real) -> Real:
        """Signal-to-noise ratio of the flat floor at ground ranges [dB]."""
        if self.sediment is not None:
            return sim.snr(sonar, self.sediment, ground_range, model=self.scattering)
        ratio = self.ratio()
        return ratio.at(ground_range) if isinstance(ratio, SnrProfile) else np.full(ground_range.shape, self.snr)

    @property
    def ranged(self) -> bool:
        """Where it has bins."""
        return self.bins is not None

    @property
    def onward(self) -> bool:
        """Where its blocks overlap."""
        return self.overlap is not None

    def record(self) -> tuple[int, int]:
        """No window holds a whole scene."""
        raise ValueError("a window is 'record'; in a scene it must be [rows, samples]")

    def check(self, sonar: Sonar) -> None:
        """ValueError unless the sonar is above the scene, and hears one part of it at a time where a warp is given."""
        self.required(sonar, 1)
        if self.plan.delays == "warp":
            self.simulate(sonar, 1, np.random.default_rng(0))

    def shape(self, sonar: Sonar, trials: int) -> tuple[int, int]:
        """One row a trial and those that overlap, as long as the scene is heard."""
        return trials + 2 * (self.overlap or 0), self.required(sonar, 1).grid.samples

    def simulate(self, sonar: Sonar, trials: int, rng: np.random.Generator, first: int = 0) -> EchoPair:
        """One row a trial and those that overlap, registered to the floor."""
        beyond = self.overlap or 0
        rows, first_row = trials + 2 * beyond, first - beyond if self.onward else 0
        required = self.required(sonar, rows, first_row)
        return simulate(
            self.scene(), sonar, rng=rng, snr=self.ratio(), rows=rows, first_row=first_row, required=required
        )

    def read(self, pair: EchoPair, window: Window, estimate: DelayEstimate) -> list[Reading]:
        """Errors outside layover, and in it; where there are bins, those outside layover alone, a region each."""
        beyond = self.overlap or 0
        if self.bins is None:
            return by_kind(pair, window, estimate, beyond)
        return over_range(pair, window, estimate, beyond, Bins(self.ground_range, self.bins), self.snr_at)

    def traces(self, pair: EchoPair) -> dict[str, Real]:
        """Slant range [m], and the true delays of all parts heard in the first row [s].

        Of blocks that go on, images of their own rows: extent of the rows and ground range of the columns [m];
        intensity, in parts of that of the noise or of the floor; and true height [m].
        """
        truth, geometry = pair.truth, pair.geometry
        assert truth is not None
        assert truth.branches is not None
        assert geometry is not None
        if self.onward:
            assert truth.height is not None
            cells = self._cells(pair)
            return {
                "row extent": np.array([cells.row_extent]),
                "ground range": geometry.ground_range(pair.grid.times)[cells.columns],
                "intensity": cells.mean(np.abs(pair.primary) ** 2),
                "truth": cells.middles(np.broadcast_to(truth.height, pair.shape)),
            }
        branches = truth.branches if truth.branches.ndim == 2 else truth.branches[:, 0]
        return {"slant range": geometry.slant_range(pair.grid.times), "truth": branches}

    def trace(self, pair: EchoPair, estimate: DelayEstimate) -> Real:
        """Delays of the first row [s]; of blocks that go on, heights of their own rows [m], as large as the images."""
        if not self.onward:
            delays: Real = estimate.delay[0]
            return delays
        assert pair.geometry is not None
        cells = self._cells(pair)
        return pair.geometry.height(pair.grid.times[cells.columns], cells.middles(estimate.delay))

    def _cells(self, pair: EchoPair) -> Cells:
        return Cells.of(pair, self.ground_range, self.overlap or 0)


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
