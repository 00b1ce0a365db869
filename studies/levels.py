"""The sonar equation over ground range, as a study asks for it: nothing is simulated."""

from typing import Annotated, Literal, Self

import numpy as np
import pandas as pd
from pydantic import Field, model_validator

from sim import SEDIMENTS, Sonar, coherence_terms, sonar_equation
from studies.quantity import Metres
from studies.section import Section


class Levels(Section):
    """A flat seabed, its sediment and its scattering model.

    Parameters
    ----------
    sediment
        A name of `sim.SEDIMENTS`.
    scattering
        The scattering model, "small-slope" or "apl-uw".
    ground_range
        Nearest and furthest ground range [m].
    ranges
        How many, evenly between them.
    """

    sediment: str
    scattering: Literal["small-slope", "apl-uw"] = "small-slope"
    ground_range: tuple[Metres, Metres]
    ranges: Annotated[int, Field(ge=2)] = 359

    @model_validator(mode="after")
    def _can_be(self) -> Self:
        near, far = self.ground_range
        if not 0 <= near < far:
            raise ValueError(f"ground_range is ({near:g}, {far:g}) m; its near end must come first, and not below 0 m")
        try:
            SEDIMENTS[self.sediment]
        except KeyError as error:
            raise ValueError(error.args[0]) from None
        return self

    def columns(self, sonar: Sonar) -> list[str]:
        """Columns of its table."""
        return list(self.table(sonar).columns)

    def table(self, sonar: Sonar) -> pd.DataFrame:
        """Every term of the sonar equation, the SNR [dB] and the factors of the coherence, a row for each range."""
        y = np.linspace(*self.ground_range, self.ranges)
        equation = sonar_equation(sonar, self.sediment, y, model=self.scattering)
        factors = coherence_terms(sonar, self.sediment, y, model=self.scattering)
        return pd.DataFrame(
            {
                "ground_range": y,
                "slant_range": equation.slant_range,
                "grazing_angle": equation.grazing_angle,
                "source_level": equation.source_level,
                "transmit_beam": equation.transmit_beam,
                "receive_beam": equation.receive_beam,
                "spreading": equation.spreading,
                "absorption": equation.absorption,
                "scattering_strength": equation.scattering_strength,
                "area": equation.area,
                "noise_level": equation.noise_level,
                "pulse_gain": equation.pulse_gain,
                "aperture_gain": equation.aperture_gain,
                "snr_db": equation.snr,
                "coherence_noise": factors.noise,
                "coherence_baseline": factors.baseline,
                "coherence_footprint": factors.footprint,
                "coherence": factors.product,
            }
        )
