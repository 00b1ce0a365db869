import pytest

from studies import catalogue, engine, report

SMALL = {
    "patch.snr": [0, 10],
    "patch.looks": [9],
    "sonar.bandwidth": ["30 kHz"],
    "trials.count": 300,
    "trials.block": 100,
}


@pytest.fixture
def small():
    """Two design points in three blocks of a hundred trials."""
    return catalogue.study("wrap-errors").with_values(SMALL)


@pytest.fixture
def table_of():
    """Run a study into a folder; its table, without the times."""

    def run(study, how, folder, **options):
        engine.run(study, how, folder, **options)
        return report.result(study, engine.store_of(study, how.seed, folder)).table.drop(columns="seconds_per_pixel")

    return run


@pytest.fixture
def plain(small, table_of, tmp_path):
    """The table of the small study, run in the plainest way into the folder `plain`."""
    return table_of(small, engine.Run(jobs=1, backend="sequential"), tmp_path / "plain")
