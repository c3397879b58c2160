"""Stations that measure other things than radars do: their tracks, fits of these, and telescopes."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from fits import fitted, without_noise
from support import BOUNDED_ESTIMATION as SETTINGS, EPOCH, environment, kepler_orbit

from opml.base.constants import DAY, HOUR, WGS84_A
from opml.base.errors import InputError
from opml.catalog.fit import measured_tracks, observations
from opml.catalog.fit.first import first_orbit
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking
from opml.catalog.simulate.observing import OBSERVABLES, StationStates, difference, measured_by, site
from opml.dynamics.frames import gcrf_to_itrf
from opml.interop import tdm
from opml.tables import STATE

PRECISE = SETTINGS.evolve(convergence=1e-4)
SIGMAS = dict(zip(OBSERVABLES, [2e-4, 2e-4, 50.0, 0.1, 2e-5, 2e-5], strict=True))


def measuring(station, *names, **changes):
    """The station with sigmas of these observables alone."""
    sigmas = {f"sigma_{name}": SIGMAS[name] if name in names else None for name in OBSERVABLES}
    return replace(station, **sigmas, **changes)


@pytest.fixture(scope="module")
def orbit(smooth_orbit):
    return smooth_orbit


@pytest.fixture(scope="module")
def mixed(three_stations):
    """A radar, one that knows ranges and their rates, and one that knows stars."""
    eglin, clear, kaena = three_stations
    stars = measuring(kaena, "right_ascension", "declination")
    return [eglin, measuring(clear, "range", "range_rate"), stars]


@pytest.fixture(scope="module")
def rows(orbit, earth_orientation, mixed):
    return tracking.simulate(orbit, earth_orientation, mixed, rso="iss", seed=1)


@pytest.mark.parametrize(
    "names",
    [
        ("range",),
        ("range_rate",),
        ("range", "range_rate"),
        ("azimuth", "elevation"),
        ("right_ascension", "declination"),
        OBSERVABLES,
    ],
)
def test_fits_of_any_measurements_find_the_truth(
    assumed_model, orbit, earth_orientation, three_stations, smooth, names
):
    stations = [measuring(station, *names) for station in three_stations]
    seen = tracking.simulate(orbit[orbit["t"] < 0.6 * DAY], earth_orientation, stations, rso="iss", seed=1)
    found = fitted(
        Propagator(assumed_model, smooth), orbit, without_noise(seen), earth_orientation, stations, PRECISE
    )
    late = found[found["tracks_used"] >= 5]
    assert len(late) > 1
    assert late["converged"].all()
    assert late["off"].max() < 0.05


def test_noise_is_of_its_sigma(rows, mixed):
    for station in mixed:
        names, seen = measured_by(station), rows[rows["station"] == station.name]
        true = seen[[f"{name}_true" for name in names]].to_numpy()
        noise = difference(seen[names].to_numpy(), true, names) / [
            getattr(station, f"sigma_{name}") for name in names
        ]
        np.testing.assert_allclose(noise.std(axis=0), 1.0, atol=6.0 / np.sqrt(len(seen)))
        others = [name for name in OBSERVABLES if name not in names]
        assert seen[[*others, *(f"{name}_true" for name in others)]].isna().all(axis=None)


def test_a_radar_measures_the_same_beside_others(rows, orbit, earth_orientation, three_stations):
    alone = tracking.simulate(orbit, earth_orientation, three_stations[:1], rso="iss", seed=1)
    beside = rows[rows["station"] == "eglin"]
    assert list(alone) == [name for name in beside if name in set(alone)]
    for name in tracking.QUANTITIES:
        np.testing.assert_array_equal(beside[name], alone[name])
    assert "range_rate" not in alone


def test_residuals_weigh_what_was_measured(assumed_model, orbit, rows, earth_orientation, mixed, smooth):
    found = fitted(Propagator(assumed_model, smooth), orbit, rows, earth_orientation, mixed, PRECISE)
    late = found[found["tracks_used"] >= 3]
    assert late["converged"].all()
    assert late["weighted_rms"].median() == pytest.approx(1.0, abs=0.1)
    measured = observations.Measured(rows, earth_orientation, mixed)
    window = measured.track(0)
    numbers = rows.loc[rows["track"] == 0, OBSERVABLES].notna().to_numpy().sum()
    assert measured.count(window.rows) == numbers < 3 * window.measurements


def test_what_a_station_has_no_sigma_of_does_not_count(rows, earth_orientation, mixed):
    blind = [measuring(station, "range") if station.is_radar else station for station in mixed]
    measured = observations.Measured(rows, earth_orientation, blind)
    held = rows.assign(station=rows["station"].replace("eglin", "clear"))
    for_radar = measured.counting[(held["station"] != rows["station"]).to_numpy()]
    assert measured.names == ["range", "range_rate", "right_ascension", "declination"]
    assert (for_radar == [True, False, False, False]).all()


def test_the_rate_is_that_of_the_range(earth_orientation, three_stations, iss):
    kaena = measuring(three_stations[2], "range", "range_rate")
    path = kepler_orbit(iss, duration=2500.0, step=0.05)
    seen = tracking.simulate(path, earth_orientation, [kaena], rso="iss", seed=1)
    slope = np.gradient(seen["range_true"], seen["t"])
    assert seen["track"].nunique() == 1
    assert np.ptp(slope) > 5e3
    np.testing.assert_allclose(seen["range_rate_true"][1:-1], slope[1:-1], atol=1e-4)


def test_stars_lie_where_horizons_say(orbit, earth_orientation, three_stations):
    every = measuring(three_stations[0], *OBSERVABLES)
    seen = without_noise(tracking.simulate(orbit, earth_orientation, [every], rso="iss", seed=1))
    by_stars = measuring(three_stations[0], "range", "right_ascension", "declination")
    at = orbit.set_index("t").loc[seen["t"], STATE[:3]].to_numpy()
    for station in (every, by_stars, three_stations[0]):
        measured = observations.Measured(seen, earth_orientation, [station])
        np.testing.assert_allclose(measured.places(np.arange(len(seen))), at, atol=1e-5)


# Telescopes ------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def telescope(three_stations):
    stars = measuring(three_stations[2], "right_ascension", "declination")
    return replace(stars, max_sun_elevation=np.radians(-12.0))


def test_a_telescope_sees_what_the_sun_lights_at_night(orbit, earth_orientation, telescope):
    by_day = replace(telescope, max_sun_elevation=None)
    always, seen = (
        tracking.simulate(orbit, earth_orientation, [one], rso="iss", seed=1, epoch=EPOCH)
        for one in (by_day, telescope)
    )
    t = always["t"].to_numpy()
    nodes = environment()["ephemerides"]
    sun = np.stack([np.interp(t, nodes["t"], nodes[f"sun_{axis}"]) for axis in "xyz"], axis=-1)
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    up = np.einsum("nji,j->ni", gcrf_to_itrf(earth_orientation, t), site(telescope)[1][2])
    height = np.degrees(np.arcsin(np.sum(sun * up, axis=1)))
    place = orbit.set_index("t").loc[t, STATE[:3]].to_numpy()
    along = np.sum(place * sun, axis=1)
    dark = (along < 0.0) & (np.linalg.norm(place - along[:, None] * sun, axis=1) < WGS84_A)
    expected = t[(height < -12.0) & ~dark]
    assert 0 < len(expected) < (height < -12.0).sum() < len(t)
    assert len(np.setxor1d(seen["t"], expected)) <= 2  # at an edge


def test_a_telescope_that_sees_by_day_only_is_an_input_error(orbit, earth_orientation, telescope):
    blind = replace(telescope, max_sun_elevation=np.radians(-89.0))
    with pytest.raises(InputError, match="iss: expected a pass over kaena, but it is never in sight"):
        tracking.simulate(orbit, earth_orientation, [blind], rso="iss", seed=1, epoch=EPOCH)


# First orbits ----------------------------------------------------------------------------------------


def test_a_known_state_is_carried_to_tracks_of_angles(
    assumed_model, orbit, earth_orientation, three_stations, smooth
):
    stars = [measuring(station, "right_ascension", "declination") for station in three_stations]
    seen = tracking.simulate(orbit, earth_orientation, stars, rso="iss", seed=1)
    measured = observations.Measured(seen, earth_orientation, stars)
    propagator, first = Propagator(assumed_model, smooth), orbit[STATE].to_numpy()[0]
    near = first_orbit.starts(propagator, measured, known=(0.0, first), settings=SETTINGS)
    at = orbit.set_index("t").loc[near["t"], STATE].to_numpy()
    np.testing.assert_allclose(near[STATE[:3]], at[:, :3], atol=1.0)
    with pytest.raises(InputError, match="iss: expected tracks near the orbit of the given elements"):
        first_orbit.starts(propagator, measured, known=(HOUR, first), settings=SETTINGS)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("range", "azimuth", "elevation"), [3e5, 4e5, 5e5]),
        (("right_ascension", "declination"), [0.0, 4e5, 4e5]),
        (("range",), [3e5, None, None]),
        (("range_rate",), [0.0, 0.0, 0.0]),
    ],
)
def test_how_far_a_place_is_from_measurements(orbit, earth_orientation, three_stations, names, expected):
    """Moved along the line of sight, across it, and both."""
    station = measuring(three_stations[0], *names)
    seen = without_noise(tracking.simulate(orbit, earth_orientation, [station], rso="iss", seed=1))
    measured, rows = observations.Measured(seen, earth_orientation, [station]), np.array([3, 30, 60])
    at = orbit.set_index("t").loc[seen["t"].iloc[rows], STATE[:3]].to_numpy()
    stands = StationStates.at(seen["t"].to_numpy()[rows], [station], np.zeros(3, int), earth_orientation)
    away = at - np.einsum("nji,nj->ni", stands.from_gcrf, stands.position)
    sight = away / np.linalg.norm(away, axis=1, keepdims=True)
    aside = np.cross(sight, [0.0, 0.0, 1.0])
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    for moved, miss in zip((3e5 * sight, 4e5 * aside, 3e5 * sight + 4e5 * aside), expected, strict=True):
        if miss is not None:
            np.testing.assert_allclose(measured.distances(rows, at + moved), miss, atol=1e-3)


# Messages --------------------------------------------------------------------------------------------


@pytest.fixture
def message(tmp_path, rows):
    path = tmp_path / "mixed.tdm"
    tdm.write(path, rows, epoch=EPOCH, rso="iss")
    return path


def test_tracks_come_back_from_a_message(message, rows, mixed):
    known = {station.name: station for station in mixed}
    found = tdm.measurements([message], epoch=EPOCH)
    measured_tracks.check(found, known, epoch=EPOCH, duration=DAY)
    back = measured_tracks.tracks(found, mixed)
    given = [name for name in rows if not name.endswith("_true")]
    assert list(back) == list(rows)
    pd.testing.assert_frame_equal(back[given], rows[given], check_exact=True)
    assert back[[name for name in rows if name.endswith("_true")]].isna().all(axis=None)


def test_angles_of_both_kinds_come_back_from_two_segments(tmp_path, orbit, earth_orientation, three_stations):
    every = measuring(three_stations[0], *OBSERVABLES)
    seen = tracking.simulate(orbit, earth_orientation, [every], rso="iss", seed=1)
    tdm.write(tmp_path / "a.tdm", seen, epoch=EPOCH, rso="iss")
    assert (tmp_path / "a.tdm").read_text().count("META_START") == 2 * seen["track"].nunique()
    back = measured_tracks.tracks(tdm.measurements([tmp_path / "a.tdm"], epoch=EPOCH), [every])
    np.testing.assert_array_equal(back[OBSERVABLES], seen[OBSERVABLES])


def test_what_stations_do_not_weigh_is_passed_over(message, rows, mixed, three_stations):
    ranges = [mixed[0], measuring(mixed[1], "range"), mixed[2]]
    back = measured_tracks.tracks(tdm.measurements([message], epoch=EPOCH), ranges)
    assert len(back) == len(rows)
    assert "range_rate" not in back
    with pytest.raises(InputError) as error:
        measured_tracks.tracks(tdm.measurements([message], epoch=EPOCH), three_stations)
    expected = "expected azimuth or elevation or range, of which kaena has a sigma"
    assert f"{expected}, got right_ascension and declination" in str(error.value)
