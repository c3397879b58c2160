"""Laser ranges: delays and tides by the numbers of the IERS, and fits that find the orbit behind them."""

import erfa
import numpy as np
import pandas as pd
import pytest
from support import EPOCH, ESTIMATION, environment, rsos

from opml.base.constants import DAY, GM, SPEED_OF_LIGHT
from opml.base.errors import InputError
from opml.catalog.fit import fixes, laser_ranges, range_corrections
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.least_squares import Fit
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.catalog.simulate.observing import StationStates, horizon, predicted
from opml.tables import SCHEMAS, STATE, read_measured, write_table

LATITUDE, HEIGHT = np.radians([30.67166667]), np.array([2010.344])
OFFSET, SIGMA = 0.25, 0.01
MARKS = {"7090": [-2389006.4, 5043329.3, -3078524.1], "7941": [4641978.8, 1393067.5, 4133249.5]}
ECCENTRICITY = [3.0, -0.5, 0.25]


def test_the_zenith_delay_is_that_of_the_iers():
    """Of the test of the IERS's routine FCUL_ZD_HPA, to 4 micrometres."""
    of_air = np.array([79841.88]), np.array([1432.2]), np.array([0.532e-6]), LATITUDE, HEIGHT
    assert range_corrections.zenith_delay(*of_air)[0] == pytest.approx(1.935225924846803, abs=4e-6)


def test_the_mapping_is_that_of_the_iers():
    """Of the test of the IERS's routine FCUL_A."""
    slant = range_corrections.mapped(np.radians([15.0]), np.array([300.15]), LATITUDE, np.array([2075.0]))
    assert slant[0] == pytest.approx(3.800243667312344, abs=1e-7)


def test_vapour_in_half_saturated_air():
    pressure = range_corrections.vapour_pressure(np.array([101325.0]), np.array([293.15]), np.array([0.5]))
    assert pressure[0] == pytest.approx(0.5 * 2339.0 * 1.004, rel=2e-3)


def test_light_is_bent_by_millimetres():
    position, station = np.array([[12.27e6, 0.0, 0.0]]), np.array([[6.378e6, 0.0, 0.0]])
    assert range_corrections.bent(position, station)[0] == pytest.approx(
        8.87e-3 * np.log(12.27 / 6.378), rel=1e-3
    )


def test_the_moon_lifts_what_it_stands_above():
    """By half of what a mass of its own size would lift an ocean: h2 GM R^4 / (GM_E d^3)."""
    up, moon = np.array([[6378e3, 0.0, 0.0]] * 3), np.zeros((3, 3))
    angle = np.radians([0.0, 90.0, 45.0])
    moon[:, 0], moon[:, 1] = 384400e3 * np.cos(angle), 384400e3 * np.sin(angle)
    moved = range_corrections.tide(up, moon, GM["moon"])
    height = 0.01230 * 6378.137e3**4 / 384400e3**3
    np.testing.assert_allclose(moved[0], [0.6081 * height, 0.0, 0.0], rtol=1e-3, atol=1e-9)
    np.testing.assert_allclose(moved[1, 0], -0.5 * moved[0, 0], rtol=1e-9)
    np.testing.assert_allclose(moved[2, 1], 1.5 * 0.0846 * height, rtol=1e-3)
    assert moved[2, 2] == 0.0


# Fits ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def sites():
    reference = pd.Timestamp("2016-01-01")
    marks = [
        {"station": name, "point": "A", "begin": pd.NaT, "end": pd.NaT, "reference": reference}
        | dict(zip("xyz", place, strict=True))
        | {"vx": 1e-9, "vy": 0.0, "vz": 0.0}
        for name, place in MARKS.items()
    ]
    away = [
        {"station": name, "system": "0513", "begin": begin, "end": end}
        | dict(zip(("up", "north", "east"), axes, strict=True))
        for name in MARKS
        for begin, end, axes in (
            (pd.Timestamp("2000-01-01"), pd.Timestamp("2016-01-01"), [9.0, 9.0, 9.0]),
            (pd.Timestamp("2016-01-01"), pd.NaT, ECCENTRICITY),
        )
    ]
    return laser_ranges.Sites(pd.DataFrame(marks), pd.DataFrame(away))


@pytest.fixture(scope="module")
def propagator(assumed_model):
    return Propagator(assumed_model, rsos()["lageos1"])


@pytest.fixture(scope="module")
def orbit(propagator):
    return truth.simulate(propagator, duration=DAY, step=120.0)


@pytest.fixture(scope="module")
def points(orbit, earth_orientation, sites):
    """Points of light there and back through air, as stations above 20 degrees count them."""
    tables, t = [], orbit["t"].to_numpy()
    states = orbit[STATE].to_numpy().reshape(-1, 2, 3)
    for station in MARKS:
        place = sites.position(station, "0513", pd.Timestamp(EPOCH))
        air = {
            "pressure": 98e3,
            "temperature": 290.0,
            "humidity": 0.4,
            "wavelength": 532e-9,
            "scatter": np.nan,
        }
        known = pd.DataFrame({"track": 0, "t": t, "station": station, "system": "0513", "flight": 1.0, **air})
        given = laser_ranges.table(known, sites, **environmental(), sigma=SIGMA, offset=0.0)
        moved, axes = (
            given[["x_station", "y_station", "z_station"]].to_numpy(),
            np.tile(_axes(place), (len(t), 1, 1)),
        )
        both = np.ones(len(t), bool)
        stands = StationStates.of_places(t, moved, axes, earth_orientation, two_way=both)
        positions, velocities = (np.einsum("nij,nj->ni", stands.from_gcrf, states[:, k]) for k in (0, 1))
        names = ["range", "elevation"]
        distance, elevation = predicted(names, positions, velocities, stands, light_time=True).T
        slant = range_corrections.mapped(elevation, known["temperature"].to_numpy(), *_level(place, len(t)))
        whole = distance + given["zenith_delay"] * slant + range_corrections.bent(positions, moved) - OFFSET
        seen = elevation > np.radians(20.0)
        tables.append(known.assign(flight=2.0 * whole / SPEED_OF_LIGHT)[seen])
    rows = pd.concat(tables).sort_values("t", kind="stable", ignore_index=True)
    passes = [
        run
        for _, one in rows.groupby("station")
        for _, run in one.groupby((one["t"].diff() > 600.0).cumsum())
    ]
    passes.sort(key=lambda run: run["t"].iloc[0])
    return pd.concat([run.assign(track=number) for number, run in enumerate(passes)], ignore_index=True)


def environmental():
    tables = environment()
    return {"epoch": EPOCH} | {name: tables[name] for name in ("earth_orientation", "ephemerides")}


def _axes(place):
    return horizon(*erfa.gc2gd(1, place)[:2])


def _level(place, count):
    _, latitude, height = erfa.gc2gd(1, place)
    return np.full(count, latitude), np.full(count, height)


def test_stations_stand_where_they_moved_to(sites):
    date = pd.Timestamp("2016-09-28")
    place = sites.position("7090", "0513", date)
    east, north, up = _axes(np.array(MARKS["7090"]))
    away = ECCENTRICITY[0] * up + ECCENTRICITY[1] * north + ECCENTRICITY[2] * east
    np.testing.assert_allclose(place - away - MARKS["7090"], [271 * DAY * 1e-9, 0.0, 0.0], atol=1e-6)
    for station, system, message in (
        ("7119", "0513", "station 7119: expected coordinates on 2016-09-28, got none"),
        ("7090", "0512", "station 7090: expected an eccentricity of its system 0512 on 2016-09-28"),
    ):
        with pytest.raises(InputError, match=message):
            sites.position(station, system, date)


def test_a_fit_finds_the_orbit_behind_ranges(tmp_path, points, sites, orbit, propagator, earth_orientation):
    table = laser_ranges.table(points, sites, **environmental(), sigma=SIGMA, offset=OFFSET)
    path = tmp_path / "ranges.parquet"
    write_table(path, table, "laser_ranges", metadata={})
    back = read_measured(path)
    assert list(back) == SCHEMAS["laser_ranges"].names
    measured = fixes.measurements(back, earth_orientation, [])
    true = orbit.set_index("t")[STATE]
    states = true.loc[measured.epochs[measured.at].round(6)].to_numpy()
    settings = ESTIMATION.evolve(window_hours=24.0, max_iterations=20, least_drag_m=1e3)
    run = Run(measured, propagator, states, np.empty(0), settings)
    last = measured.tracks - 1
    off = states[last] + [30.0, -20.0, 10.0, 0.02, 0.01, -0.02]
    free = np.arange(7) < 6
    estimate = Estimate(measured.window(last, DAY), Fit(np.append(off, propagator.rso.cd), run.method(free)))
    run.fit([estimate])
    assert estimate.fit.converged
    assert estimate.window.tracks > 5
    assert np.linalg.norm(estimate.fit.best[:3] - states[last, :3]) < 0.02
    [left] = run.residuals([estimate])
    assert set(measured.stations[estimate.window.rows]) == set(MARKS)
    assert measured.names == ["range"]
    assert SIGMA * np.abs(left).max() < 3e-3
    np.testing.assert_allclose(measured.distances(measured.first_row[:-1], states[:, :3]), 0.0, atol=200.0)


def test_a_point_weighs_no_more_than_its_own_ranges_do(points, sites):
    scattered = points.assign(scatter=[0.07, 0.001, *[np.nan] * (len(points) - 2)])
    table = laser_ranges.table(scattered, sites, **environmental(), sigma=SIGMA, offset=OFFSET)
    spread = table.set_index(table["t"])["sigma_range"]
    assert spread[points["t"].iloc[:3]].tolist() == [0.07, SIGMA, SIGMA]


def test_passes_that_overlap_are_one_track(points, sites):
    first = points[points["track"] == 0]
    late = first.assign(track=9, station="7941", t=first["t"] + 30.0)
    apart = first.assign(track=2, t=first["t"] + DAY)
    both = pd.concat([first, apart, late], ignore_index=True)
    table = laser_ranges.table(both, sites, **environmental(), sigma=SIGMA, offset=OFFSET)
    assert table.groupby("track").size().tolist() == [2 * len(first), len(first)]
    assert (table.groupby("track")["t"].diff().dropna() > 0.0).all()
    stood = np.linalg.norm(table[["x_station", "y_station", "z_station"]], axis=1)
    by_station = pd.Series(stood).groupby(table["station"])
    assert (by_station.max() - by_station.min()).max() < 1.0


def test_points_outside_of_the_run_are_left_out(points):
    last = points["t"].max()
    assert laser_ranges.of_run(points, 0.5 * last)["t"].between(0.0, 0.5 * last).all()
    days = "normal points within the run, of 1 days, got some from day \\+10.*"
    with pytest.raises(InputError, match=days):
        laser_ranges.of_run(points.assign(t=points["t"] + 10 * DAY, path="a.crd"), DAY)


def test_stations_may_be_left_out(points):
    assert set(laser_ranges.of_run(points, DAY, without=[7090])["station"]) == {"7941"}
    with pytest.raises(InputError, match=r"a\.crd: expected others within the run"):
        laser_ranges.of_run(points.assign(path="a.crd"), DAY, without=[7090, 7941])
