"""Laser ranges that were really measured: LAGEOS-2 by three stations in a day, to centimetres."""

import numpy as np
import pytest
from support import shared

from validation import laser


@pytest.fixture(scope="module")
def fits():
    return laser.fits(shared("real") / "crd")


def test_a_day_of_three_stations_is_fitted_to_two_centimetres(fits):
    day = fits["the last 18 hours"]
    assert day.by_station["points"].to_dict() == {"7090": 37, "7119": 27, "7941": 14}
    assert day.by_station["rms"].max() < 2.0
    assert np.abs(day.by_station["mean"]).max() < 1.5


def test_three_days_of_four_stations_are_fitted_to_a_decimetre(fits):
    days = fits["three days"]
    assert len(days.by_station) == 4
    assert days.by_station["rms"].max() < 8.0


def test_both_orbits_are_near_the_prediction(fits):
    for fit in fits.values():
        assert np.linalg.norm(fit.from_prediction) < 0.5
