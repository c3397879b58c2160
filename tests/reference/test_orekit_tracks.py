"""Tracks in a message that Orekit wrote of its own orbit: through first orbit, estimates, predictions."""

import numpy as np
import pandas as pd
import pytest
from support import ASSUMED_BODIES, EPOCH, ESTIMATION, EXCERPTS, force_model

from opml.base.constants import DAY
from opml.catalog.associate import quarantine
from opml.catalog.fit import measured_tracks, observations
from opml.catalog.fit.first import first_orbit
from opml.catalog.predict import prediction
from opml.catalog.propagator import Propagator
from opml.interop import tdm
from opml.tables import STATE


@pytest.fixture(scope="module")
def orbit():
    """Orekit's orbit at the measured times."""
    return pd.read_csv(EXCERPTS / "orekit_tdm_orbit.csv", comment="#").set_index("t")[STATE]


@pytest.fixture(scope="module")
def tracking(three_stations):
    found = tdm.measurements([EXCERPTS / "orekit.tdm"], epoch=EPOCH)
    known = {station.name: station for station in three_stations}
    measured_tracks.check(found, known, epoch=EPOCH, duration=2 * DAY)
    return measured_tracks.tracks(found, three_stations)


@pytest.fixture(scope="module")
def propagator(iss):
    return Propagator(force_model(20, ASSUMED_BODIES), iss)


@pytest.fixture(scope="module")
def measured(tracking, earth_orientation, three_stations):
    return observations.Measured(tracking, earth_orientation, three_stations)


@pytest.fixture(scope="module")
def starts(propagator, measured):
    return first_orbit.determined(propagator, measured, settings=ESTIMATION)


@pytest.fixture(scope="module")
def estimates(propagator, starts, measured):
    return quarantine.estimate_all(propagator, starts, measured, settings=ESTIMATION)


def errors(table, orbit):
    """Position errors [m]."""
    states = table[STATE].to_numpy() - orbit.loc[table["t"]].to_numpy()
    return np.linalg.norm(states[:, :3], axis=1)


def test_every_measurement_is_read(tracking, orbit):
    assert set(tracking["station"]) == {"eglin", "clear", "kaena"}
    assert set(tracking["t"]) == set(orbit.index)
    assert tracking["track"].nunique() == 26


def test_the_first_orbit_is_good_enough_to_start_from(starts, orbit):
    assert errors(starts, orbit).max() < 10e3


def test_estimates_are_where_orekit_has_the_rso(estimates, orbit):
    assert estimates["converged"].all()
    many = estimates["tracks_used"] >= 4
    assert many.sum() > 15
    found = errors(estimates[many], orbit)
    assert np.median(found) < 75.0
    assert found.max() < 200.0
    assert 0.8 < estimates["weighted_rms"][many].mean() < 1.2


def test_predictions_need_no_truth(propagator, estimates, orbit):
    found = prediction.predict_all(propagator, None, estimates, max_days=1.0)
    assert found.filter(like="_true").isna().all(axis=None)
    assert found.filter(regex="^e_").isna().all(axis=None)
    assert (found["reason"] == "").mean() > 0.9
    used = found[found["i"].isin(estimates.index[estimates["tracks_used"] >= 4])]
    apart = errors(used.rename(columns={"t_j": "t"}), orbit)
    assert np.median(apart) < 500.0
