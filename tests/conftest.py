import os
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import settings

# Every run of the same commit in CI draws the same examples; elsewhere they are new each time.
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")


@pytest.fixture(scope="session")
def oracle():
    """Reference numbers by file name, as a table."""
    return lambda name: pd.read_csv(Path(__file__).parent / "oracles" / f"{name}.csv")
