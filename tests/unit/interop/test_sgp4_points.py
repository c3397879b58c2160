"""Points before the epoch of mean elements, and fits to them."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from sgp4.api import Satrec
from support import BOUNDED_ESTIMATION, EPOCH

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.catalog.fit import estimation, first_orbit, fixes
from opml.catalog.flight import Flight
from opml.interop.ccsds import utc_texts
from opml.interop.element_sets import mean_elements, sgp4_points
from opml.tables import STATE

SIGMAS = [300.0, 1000.0, 300.0, *[np.nan] * 3]


def elements(days, drag=2e-5):
    """Mean elements of an ISS, so many days after the run's epoch."""
    satellite, day = Satrec(), epochs.utc(EPOCH, DAY * days)
    since = float(sum(day)) - 2433281.5
    angles = np.radians([250.0, 51.64, 100.0, 80.0 + 5.0 * days])
    satellite.sgp4init(0, "i", 25544, since, drag, 0.0, 0.0, 0.0006, *angles[:3], 0.0676, angles[3])
    return satellite


@pytest.mark.parametrize("days", [1.0, 2.5])
def test_points_are_states_of_sgp4_up_to_the_epoch(days):
    satellite = elements(days)
    end, points = sgp4_points.before(satellite, epoch=EPOCH, reach=12 * HOUR, step=600.0, sigmas=SIGMAS)
    assert end == pytest.approx(DAY * days, abs=1e-3)
    assert len(points) == 73
    assert points["t"].iloc[-1] == end
    for row in (0, 40, 72):
        (time,) = utc_texts(EPOCH, points["t"].to_numpy()[row : row + 1])
        expected = mean_elements.state(satellite, epoch=time)
        assert np.abs(points[STATE].to_numpy()[row] - expected).max() < 0.01


def test_fits_to_sets_are_at_their_epochs_and_as_close_as_sgp4_is(assumed_model, iss):
    sets = [
        sgp4_points.before(elements(days), epoch=EPOCH, reach=12 * HOUR, step=600.0, sigmas=SIGMAS)
        for days in (1.0, 2.5)
    ]
    table = fixes.of_sets(np.array([end for end, _ in sets]), [points for _, points in sets])
    settings = replace(BOUNDED_ESTIMATION, window_hours=0.0, cd_sigma=0.5)
    flight, measured = Flight(assumed_model, iss), fixes.Fixes(table)
    starts = first_orbit.starts(flight, measured, known=None, settings=settings)
    found = estimation.estimate_all(flight, starts, measured, settings=settings)
    assert found["converged"].all()
    pd.testing.assert_series_equal(found["t"], starts["t"])
    apart = np.linalg.norm((found[STATE[:3]] - starts[STATE[:3]]).to_numpy(), axis=1)
    assert ((apart > 10.0) & (apart < 3e3)).all()
    assert found["weighted_rms"].between(0.01, 3.0).all()


def test_an_orbit_that_sgp4_loses_is_told():
    with pytest.raises(InputError, match=r"mean elements: expected an orbit at -1209600 s, got"):
        sgp4_points.before(elements(1.0, drag=0.1), epoch=EPOCH, reach=2000.0 * DAY, step=DAY, sigmas=SIGMAS)
