"""An experiment of one's own: a function that simulates, estimates and gives the table of a study."""

from typing import Annotated

import numpy as np
import pandas as pd
from pydantic import Field

from sim import Sonar
from studies.named import called, imported
from studies.section import Section


class Experiment(Section):
    """What the errors of single trials do not tell, such as how neighbouring estimates depend on each other.

    It is measured as a whole and not stored in blocks: a report measures it again, with the same numbers.

    Parameters
    ----------
    measure
        `module:function`, from the sonar, the number of rows and a random generator to a table.
    rows
        Rows along track of whatever it simulates.
    seed
        Of its random numbers.
    """

    measure: str
    rows: Annotated[int, Field(ge=1)]
    seed: Annotated[int, Field(ge=0)] = 2026

    def table(self, sonar: Sonar) -> pd.DataFrame:
        """What it gives; ValueError where it fails."""
        rng = np.random.Generator(np.random.Philox(self.seed))
        return called(f"measure {self.measure}", imported(self.measure, "measure"), pd.DataFrame, sonar, self.rows, rng)
