"""First orbits of tracks without ranges: circles through two lines of sight, and tracks that are linked."""

from dataclasses import replace

import numpy as np
import pytest
from fits import distances
from support import BOUNDED_ESTIMATION as SETTINGS

from opml.base.constants import DAY, EARTH_GM
from opml.base.errors import InputError
from opml.catalog.associate import quarantine
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.first.round_orbits import eccentricity, round_orbits
from opml.catalog.fit.first.track_fits import start_estimate_there
from opml.catalog.fit.observations import Measured
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.catalog.simulate.observing import OBSERVABLES
from opml.orbits.elements import cartesian_from_coe

ARCSEC = np.radians(1.0 / 3600.0)


@pytest.fixture(scope="module")
def rsos(iss):
    """A low orbit, one that stands still over the stations, and one far from a circle."""
    still = replace(iss, name="geo", a=42_164e3, e=3e-4, i=0.05, raan=0.0, argp=0.0, mean_anomaly=2.0)
    return {"iss": iss, "geo": still, "long": replace(iss, name="long", a=9.5e6, e=0.25)}


@pytest.fixture(scope="module")
def orbits(truth_model, rsos):
    """Orbits of them in steps of ten seconds."""
    return {
        name: truth.simulate(Propagator(truth_model, rso), duration=0.7 * DAY, step=10.0)
        for name, rso in rsos.items()
    }


@pytest.fixture
def seen(orbits, earth_orientation, three_stations):
    """Tracks of some minutes, one a pass, or one every three hours, and their stations."""

    def tracks(name, sigmas, *, minutes=1.0):
        others = {f"sigma_{one}": sigmas.get(one) for one in OBSERVABLES}
        stations = [replace(station, max_range=5e7, **others) for station in three_stations]
        rows = tracking.simulate(orbits[name], earth_orientation, stations, rso=name, seed=1)
        passes = rows.groupby([rows["track"], rows["t"] // 10_800.0])
        is_first = rows["station"] == passes["station"].transform("first")
        since = rows["t"] - passes["t"].transform("first")
        rows = rows[is_first & (since <= 60.0 * minutes)].reset_index(drop=True)
        return rows.assign(track=np.cumsum(np.diff(rows["t"], prepend=-np.inf) > 60.0) - 1), stations

    return tracks


def test_a_circle_is_found_through_two_lines_of_sight():
    turn = np.array([0.2, 0.3])
    states = [cartesian_from_coe(np.array([7.4e6, 0.0, 1.1, 0.5, 0.0, angle]), EARTH_GM) for angle in turn]
    t = np.diff(turn, prepend=turn[0]).cumsum() / np.sqrt(EARTH_GM / 7.4e6**3)
    ground = np.array([states[0][:3], states[1][:3] + [1e5, 0.0, 0.0]])
    ground *= 6.378e6 / np.linalg.norm(ground, axis=1, keepdims=True)
    away = np.array([state[:3] for state in states]) - ground
    sights = away / np.linalg.norm(away, axis=1, keepdims=True)
    found = round_orbits(t, ground, sights, EARTH_GM)
    off = np.abs(found - states[0])
    best = off[np.argmin(off[:, 0])]
    assert best[:3].max() < 1e3
    assert best[3:].max() < 5.0


def test_the_eccentricity_changes_with_the_state_as_it_says():
    state = cartesian_from_coe(np.array([8e6, 0.1, 0.9, 0.3, 1.1, 0.7]), EARTH_GM)
    vector, derivative = eccentricity(state, EARTH_GM)
    assert np.linalg.norm(vector) == pytest.approx(0.1)
    steps = np.diag([1.0] * 3 + [1e-3] * 3)
    changes = [
        eccentricity(state + step, EARTH_GM)[0] - eccentricity(state - step, EARTH_GM)[0] for step in steps
    ]
    np.testing.assert_allclose(
        derivative, np.transpose(changes) / (2.0 * steps.max(axis=1)), rtol=1e-4, atol=1e-12
    )


STARS = {"right_ascension": 5.0 * ARCSEC, "declination": 5.0 * ARCSEC}
MOUNT = {"azimuth": np.radians(0.05), "elevation": np.radians(0.05)}


@pytest.mark.parametrize(
    ("name", "sigmas", "minutes", "most"),
    [
        ("iss", STARS, 1.0, 10e3),
        ("iss", MOUNT, 1.0, 60e3),
        ("iss", MOUNT | {"range_rate": 0.5}, 1.0, 30e3),
        ("geo", STARS, 1.0, 200e3),
        ("long", STARS, 5.0, 20e3),
    ],
)
def test_short_tracks_of_angles_are_linked(
    assumed_model, rsos, orbits, seen, earth_orientation, name, sigmas, minutes, most
):
    rows, stations = seen(name, sigmas, minutes=minutes)
    measured = Measured(rows, earth_orientation, stations)
    starts = first_orbit.determined(Propagator(assumed_model, rsos[name]), measured, settings=SETTINGS)
    assert starts["track"].tolist() == rows["track"].unique().tolist()
    assert distances(starts, orbits[name]).max() < most


def test_fits_go_on_from_telescopes_tracks(assumed_model, iss, orbits, seen, earth_orientation):
    rows, stations = seen("iss", STARS, minutes=3.0)
    measured = Measured(rows, earth_orientation, stations)
    propagator = Propagator(assumed_model, iss)
    starts = first_orbit.determined(propagator, measured, settings=SETTINGS)
    found = quarantine.estimate_all(propagator, starts, measured, settings=SETTINGS)
    many = found["tracks_used"] >= 3
    assert found["converged"][many].all()
    assert distances(found[many], orbits["iss"]).max() < 1e3


def test_no_arc_is_flown_that_is_faster_than_any_orbit(assumed_model, iss, seen, earth_orientation):
    rows, stations = seen("iss", STARS)
    measured = Measured(rows, earth_orientation, stations)
    run = Run(measured, Propagator(assumed_model, iss), np.empty((0, 6)), np.empty(0), SETTINGS)
    start = np.array([7e6, 0.0, 0.0, 0.0, 1.3e7, 0.0, 2.2])
    estimate = start_estimate_there(run, measured.track(0), start)
    run.fit([estimate])
    assert estimate.fit.reason == "start arc faster than any orbit"


def test_tracks_of_several_objects_are_told(assumed_model, iss, seen, earth_orientation):
    """Each track is seen elsewhere in the sky."""
    rows, stations = seen("iss", STARS)
    track = rows["track"].to_numpy()
    turned = np.random.default_rng(1).uniform(0.3, 1.0, track.max() + 1)[track]
    others = Measured(
        rows.assign(right_ascension=rows["right_ascension"] + turned), earth_orientation, stations
    )
    with pytest.raises(
        InputError, match=r"iss: expected tracks of angles that fit one orbit, got \d+ in 12 h"
    ):
        first_orbit.determined(Propagator(assumed_model, iss), others, settings=SETTINGS)
