"""Forecast ephemerides: predictions as they are, known as far as the futures about them lie."""

import numpy as np
import pandas as pd
import pytest
import weather_files
from support import EPOCH, force_model

from opml.base.constants import DAY, HOUR
from opml.catalog.propagator import Propagator
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.forces import with_outlooks
from opml.ephemerides import forecast
from opml.ephemerides.ephemeris_task import Grid, Task
from opml.ephemerides.known_tables import KnownTables
from opml.interop import oem, orbit_segments
from opml.tables import (
    PARAMETER_COVARIANCES,
    PARAMETERS,
    SCHEMAS,
    STATE,
    STATE_COVARIANCES,
    read_table,
    symmetric_matrices,
    write_table,
)

TIMES = np.array([0.0, 6.0]) * HOUR
GRID = Grid(step=600.0, max_days=0.5, end=2.0 * DAY)


@pytest.fixture(scope="module")
def outlook():
    return weather_files.outlook(60, days=1)


@pytest.fixture(scope="module")
def propagator(iss, outlook):
    return Propagator(with_outlooks(force_model(2), outlook), iss)


@pytest.fixture(scope="module")
def known(iss):
    """Estimates 10 m from the truth in each component, that know their velocity and Cd well."""
    model = force_model(2)
    sigma = dict(zip(PARAMETERS, [10.0] * 3 + [1e-4] * 3 + [1e-3], strict=True))
    at = dict(zip(STATE, np.tile(initial_state(iss, model.gm), (2, 1)).T, strict=True))
    fit = dict.fromkeys(PARAMETER_COVARIANCES, 0.0) | {f"cov_{a}_{a}": sigma[a] ** 2 for a in PARAMETERS}
    estimates = pd.DataFrame({"track": range(2), "t": TIMES, "converged": True, **at, "cd": 2.2, **fit})
    return KnownTables(estimates, pd.DataFrame({"cd_inside": [True, True]}), 12.0, model.gm)


@pytest.fixture(scope="module")
def task(propagator, known):
    return Task(propagator, known, known.estimates, GRID)


def built(task, outlook, storms):
    """Ephemerides from both estimates; Kp of each of the futures is that of the outlook and so much more."""
    members = [
        outlook.assign(kp_3h=outlook["kp_3h"] + more, kp_24h=outlook["kp_24h"] + more, member=k)
        for k, more in enumerate(storms)
    ]
    futures = pd.concat(members, ignore_index=True)
    return forecast.build(task, futures, seed=1)


@pytest.fixture(scope="module")
def table(task, outlook):
    return built(task, outlook, [0.0, 3.0] * 8)


def test_states_are_the_predictions(task, table, tmp_path):
    (pairs,) = (part.columns() for part in task.parts())
    np.testing.assert_allclose(table[STATE], pairs[STATE], rtol=0.0, atol=1e-6)
    write_table(tmp_path / "f.parquet", table, "forecast", metadata={})
    assert list(read_table(tmp_path / "f.parquet", "forecast").columns) == SCHEMAS["forecast"].names


def test_positions_are_known_by_the_fit_at_first_and_by_the_weather_in_the_end(task, outlook, table):
    calm = built(task, outlook, [0.0] * 16)
    for one in (table, calm):
        first = one.groupby("i").first()
        # Sixteen draws tell a deviation of 10 m to a fifth.
        assert np.sqrt(first["cov_y_y"]).tolist() == pytest.approx([10.0, 10.0], rel=0.5)
        assert (np.linalg.eigvalsh(symmetric_matrices(one, STATE_COVARIANCES)) > 0.0).all()
    stormy, quiet = (np.sqrt(one.groupby("i")["cov_y_y"].last()) for one in (table, calm))
    assert (stormy > 2.0 * quiet).all()


def test_distances_are_from_the_prediction_and_not_from_the_futures_mean():
    ensemble = pd.DataFrame({"d_x": 0.0, "d_y": [3.0, 1.0, 4.0, 1.0], "d_z": [0.0, 2.0, 0.0, -2.0]})
    np.testing.assert_allclose(forecast.distances(ensemble, 2), [[0.0, np.sqrt(12.5), 0.0], [0.0, 1.0, 2.0]])


def test_its_message_says_what_it_is(table, tmp_path):
    oem.write(tmp_path / "f.oem", oem.SEGMENTS["forecast"](table, rso="iss"), epoch=EPOCH)
    assert "prediction, with the weather's covariances, from the estimate of track 1" in (
        tmp_path / "f.oem"
    ).read_text(encoding="utf-8")
    assert [segment.covariance_frame for segment in orbit_segments.read(tmp_path / "f.oem", epoch=EPOCH)] == [
        "RSW"
    ] * 2
