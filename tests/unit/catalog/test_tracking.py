"""When stations see an RSO, and what they measure."""

from dataclasses import replace

import erfa
import numpy as np
import pandas as pd
import pytest

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import tracking, truth
from opml.catalog.simulate.observing import observe, site
from opml.dynamics.frames import gcrf_to_itrf
from opml.orbits.elements import wrap_half_turn
from opml.tables import STATE


@pytest.fixture(scope="module")
def orbit(truth_model, iss):
    """Three days of the paper's RSO."""
    return truth.simulate(Propagator(truth_model, iss), duration=3 * DAY, step=20.0)


@pytest.fixture(scope="module")
def table(orbit, earth_orientation, three_stations):
    return tracking.simulate(orbit, earth_orientation, three_stations, rso="iss", seed=42)


def truth_at(positions, earth_orientation, step=20.0):
    """A `truth` table of states at rest, whose positions in ITRF are (n, 3)."""
    t = step * np.arange(len(positions))
    gcrf = np.einsum("nji,nj->ni", gcrf_to_itrf(earth_orientation, t), positions)
    return pd.DataFrame({"t": t, **dict(zip(STATE, np.column_stack([gcrf, 0.0 * gcrf]).T, strict=True))})


def overhead(station, pattern):
    """ITRF positions above a station where the pattern has 1, on the Earth's other side where it has 0."""
    place = site(station)[0]
    return np.array([place * 1.1 if seen else place * -1.1 for seen in pattern])


def test_azimuth_elevation_and_range_by_hand(three_stations):
    greenwich = replace(three_stations[0], latitude=0.0, longitude=0.0, altitude=100.0)
    place = [WGS84_A + 100.0, 0.0, 0.0]
    directions = {  # up, east, north: azimuth, elevation
        (0.0, 5e5, 0.0): (90.0, 0.0),
        (0.0, 0.0, 5e5): (0.0, 0.0),
        (0.0, -5e5, 0.0): (270.0, 0.0),
        (0.0, 0.0, -5e5): (180.0, 0.0),
        (5e5, 5e5, 0.0): (90.0, 45.0),
        (-1e5, 1e5, 1e5): (45.0, np.degrees(-np.arctan(np.sqrt(0.5)))),
    }
    found = observe(np.array(place) + np.array(list(directions)), *site(greenwich))
    np.testing.assert_allclose(np.degrees(found[:, :2]), list(directions.values()), atol=1e-9)
    np.testing.assert_allclose(found[:, 2], np.linalg.norm(list(directions), axis=1), rtol=1e-12)


def test_a_station_elsewhere_has_its_own_horizon(three_stations):
    kaena = three_stations[2]
    place, to_horizon = site(kaena)
    lon, lat, altitude = erfa.gc2gd(1, place)
    expected = (kaena.longitude, kaena.latitude, kaena.altitude)
    np.testing.assert_allclose((lon, lat, altitude), expected, rtol=1e-9)
    np.testing.assert_allclose(to_horizon @ to_horizon.T, np.eye(3), atol=1e-15)
    higher = erfa.gd2gc(1, lon, lat, altitude + 1e5)
    _, elevation, distance = observe(higher, place, to_horizon)
    assert elevation == pytest.approx(np.pi / 2, abs=1e-7)
    assert distance == pytest.approx(1e5, abs=1e-6)
    north, east = erfa.gd2gc(1, lon, lat + 1e-4, altitude), erfa.gd2gc(1, lon + 1e-4, lat, altitude)
    assert np.cos(observe(north, place, to_horizon)[0]) > 1.0 - 1e-8
    assert observe(east, place, to_horizon)[0] == pytest.approx(np.pi / 2, abs=1e-4)


@pytest.mark.parametrize(
    ("low", "high", "far"),
    [(1.0, 90.0, 13_210e3), (10.0, 90.0, 13_210e3), (1.0, 30.0, 1e8), (1.0, 90.0, 900e3)],
)
def test_a_measurement_is_made_within_all_limits_and_only_there(
    orbit, earth_orientation, three_stations, low, high, far
):
    station = replace(
        three_stations[0], min_elevation=np.radians(low), max_elevation=np.radians(high), max_range=far
    )
    found = tracking.simulate(orbit, earth_orientation, [station], rso="iss", seed=1)
    rotations = gcrf_to_itrf(earth_orientation, orbit["t"].to_numpy())
    positions = np.einsum("nij,nj->ni", rotations, orbit[["x", "y", "z"]].to_numpy())
    true = observe(positions, *site(station))
    seen = (np.degrees(true[:, 1]) >= low) & (np.degrees(true[:, 1]) <= high) & (true[:, 2] <= far)
    np.testing.assert_array_equal(found["t"], orbit["t"][seen])
    np.testing.assert_array_equal(found[["azimuth_true", "elevation_true", "range_true"]], true[seen])
    assert 0 < seen.sum() < len(seen)


@pytest.mark.parametrize(
    ("pattern", "missing", "tracks"),
    [
        ([0, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0], [], [0, 0, 1, 2, 2, 2]),
        ([1, 1, 0, 1], [], [0, 0, 1]),
        ([0, 1, 1, 1, 1, 1, 1, 0], [], [0] * 6),
        ([0, 1, 1, 1, 1, 1, 1, 0], [3], [0, 0, 1, 1, 1]),
        ([0, 1, 1, 1, 1, 1, 1, 0], [1], [0] * 5),
        ([0, 1, 1, 1, 1, 1, 1, 0], [3, 4], [0, 0, 1, 1]),
    ],
    ids=["runs", "from the epoch on", "whole", "gap", "gap before", "two gaps"],
)
def test_tracks_are_runs_of_epochs_of_the_orbit(earth_orientation, three_stations, pattern, missing, tracks):
    eglin = three_stations[0]
    orbit = truth_at(overhead(eglin, pattern), earth_orientation).drop(index=missing)
    found = tracking.simulate(orbit, earth_orientation, [eglin], rso="toy", seed=1)
    assert found["track"].tolist() == tracks
    seen = [20.0 * k for k, above in enumerate(pattern) if above and k not in missing]
    assert found["t"].tolist() == seen


def test_a_track_is_handed_from_station_to_station(earth_orientation, three_stations):
    eglin, _, kaena = three_stations
    positions = overhead(eglin, [1, 1, 0, 0, 0, 1])
    positions[2:4] = overhead(kaena, [1, 1])
    found = tracking.simulate(
        truth_at(positions, earth_orientation), earth_orientation, [eglin, kaena], rso="toy", seed=1
    )
    assert found["track"].tolist() == [0, 0, 0, 0, 1]
    assert found["station"].tolist() == ["eglin", "eglin", "kaena", "kaena", "eglin"]


def test_rows_go_by_time_then_by_the_sheets_order(table, three_stations):
    order = table["station"].map({station.name: k for k, station in enumerate(three_stations)})
    keys = table["t"].to_numpy() * 10.0 + order.to_numpy()
    assert np.all(np.diff(keys) > 0.0)
    assert set(table["station"]) == {"eglin", "clear", "kaena"}


def test_a_station_measures_the_same_alone_and_among_others(table, orbit, earth_orientation, three_stations):
    for station in three_stations:
        alone = tracking.simulate(orbit, earth_orientation, [station], rso="iss", seed=42)
        among = table[table["station"] == station.name].reset_index(drop=True)
        pd.testing.assert_frame_equal(
            alone.drop(columns="track"), among.drop(columns="track"), check_exact=True
        )


def test_noise_has_the_stations_sigmas(table, three_stations):
    for station in three_stations:
        rows = table[table["station"] == station.name]
        noise = np.stack([rows[name] - rows[f"{name}_true"] for name in tracking.QUANTITIES])
        noise[0] = wrap_half_turn(noise[0])
        noise /= [[getattr(station, f"sigma_{name}")] for name in tracking.QUANTITIES]
        count = noise.shape[1]
        assert count > 100
        assert np.all(np.abs(noise.mean(axis=1)) < 4.0 / np.sqrt(count))
        assert np.all(np.abs(noise.std(axis=1) - 1.0) < 4.0 / np.sqrt(2 * count))
        assert np.all(np.abs(np.corrcoef(noise) - np.eye(3)) < 4.0 / np.sqrt(count))
        assert np.abs(np.corrcoef(noise[0, 1:], noise[0, :-1])[0, 1]) < 4.0 / np.sqrt(count)


def test_noise_depends_on_seed_station_and_rso(orbit, earth_orientation, three_stations):
    def noise(station, **names):
        found = tracking.simulate(orbit, earth_orientation, [station], **{"rso": "iss", "seed": 42} | names)
        return (found["range"] - found["range_true"]).to_numpy()[:50]

    eglin = three_stations[0]
    assert not np.allclose(noise(eglin), noise(eglin, seed=43))
    assert not np.allclose(noise(eglin), noise(eglin, rso="iss_i50"))
    assert not np.allclose(noise(eglin), noise(replace(eglin, name="other")))


def test_noisy_azimuth_stays_within_a_turn(earth_orientation, three_stations):
    eglin = replace(three_stations[0], sigma_azimuth=np.radians(5.0))
    place, to_horizon = site(eglin)
    north = np.repeat((place + to_horizon[1] * 1e6 + to_horizon[2] * 5e5)[None], 200, axis=0)
    found = tracking.simulate(
        truth_at(north, earth_orientation), earth_orientation, [eglin], rso="toy", seed=1
    )
    assert found["azimuth"].between(0.0, 2.0 * np.pi, inclusive="left").all()
    assert (found["azimuth"] > 6.0).sum() > 50 < (found["azimuth"] < 0.3).sum()


def test_an_rso_that_no_station_sees_is_an_input_error(earth_orientation, three_stations):
    eglin, clear, _ = three_stations
    away = truth_at(overhead(eglin, [0, 0, 0]), earth_orientation)
    with pytest.raises(InputError, match="toy: expected a pass over eglin, clear, but it is never in sight"):
        tracking.simulate(away, earth_orientation, [eglin, clear], rso="toy", seed=1)
