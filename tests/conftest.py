from pathlib import Path

import pandas as pd
import pytest


@pytest.fixture(scope="session")
def oracle():
    """Reference numbers by file name, as a table."""
    return lambda name: pd.read_csv(Path(__file__).parent / "oracles" / f"{name}.csv")
