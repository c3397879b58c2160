"""Two orbits compared with each other: distances in RSW, what a covariance holds, and all formats."""

import json
from datetime import datetime, timedelta

import numpy as np
import orbit_files
import pandas as pd
import pytest
from element_histories import history, tle_text
from support import EPOCH as RUN, environment, refusal
from test_approaches import kepler

from opml import cli
from opml.base.constants import EARTH_GM
from opml.base.errors import InputError
from opml.interop import comparison, known_orbits, oem
from opml.interop.ccsds import utc_texts
from opml.interop.ephemeris import Ephemeris
from opml.interop.object_ids import ObjectId
from opml.orbits.elements import rsw_rotation
from opml.tables import SCHEMAS, STATE as STATE_COLUMNS, read_table, write_table

RADIUS = 7e6
SPEED = np.sqrt(EARTH_GM / RADIUS)
STATE = np.array([RADIUS, 0.0, 0.0, 0.0, 0.6 * SPEED, 0.8 * SPEED])
T = np.arange(0.0, 7201.0, 60.0)
SIGMA = np.array([30.0, 200.0, 10.0])


def moved(states, apart):
    """States [m, m/s] on their circle, farther out, ahead by an arc, and across, by metres each."""
    out, ahead, across = np.broadcast_to(apart, (len(states), 3)).T[:, :, None]
    axes = rsw_rotation(states)
    angle = ahead / RADIUS
    x, y, z = (axes[:, k] for k in range(3))
    positions = (RADIUS + out) * (np.cos(angle) * x + np.sin(angle) * y) + across * z
    velocities = SPEED * (np.cos(angle) * y - np.sin(angle) * x)
    return np.hstack([positions, velocities])


def written(path, states, covariances=None, frame="RSW"):
    known = {} if covariances is None else {"covariance_t": T, "covariances": covariances}
    oem.write(path, [Ephemeris("ONE", T, states, covariance_frame=frame, **known)], epoch=RUN)
    return path


@pytest.fixture(scope="module")
def truth():
    return kepler(STATE, 0.0, T)


def test_the_distance_along_the_track_is_an_arc(truth, tmp_path):
    other = written(tmp_path / "truth.oem", truth)
    ours = written(tmp_path / "ours.oem", moved(truth, [50.0, 400e3, -20.0]))
    table = comparison.compare(known_orbits.read([ours]), known_orbits.read([other]))
    assert len(table) == len(T)
    np.testing.assert_allclose(table[["r", "s", "w"]], np.tile([50.0, 400e3, -20.0], (len(T), 1)), rtol=1e-6)
    assert table["ellipsoid"].isna().all()
    assert table["hours"].iloc[-1] == pytest.approx(2.0)


@pytest.mark.parametrize("frame", ["RSW", "GCRF"])
def test_a_true_covariance_holds_what_it_says(truth, tmp_path, frame):
    misses = SIGMA * np.random.default_rng(3).normal(size=(len(T), 3))
    covariances = np.tile(np.diag(np.square([*SIGMA, 1.0, 1.0, 1.0])), (len(T), 1, 1))
    states = moved(truth, misses)
    states[:, 3:] = truth[:, 3:]
    if frame == "GCRF":
        turns = np.kron(np.eye(2), rsw_rotation(states).transpose(0, 2, 1))
        covariances = turns @ covariances @ turns.transpose(0, 2, 1)
    ours = known_orbits.read([written(tmp_path / "ours.oem", states, covariances, frame)])
    np.testing.assert_allclose(ours.covariance(f"{RUN}Z"), np.diag([*SIGMA**2, 1.0, 1.0, 1.0]), atol=0.1)
    assert np.isnan(ours.covariance("2016-01-01T00:00:00")).all()
    table = comparison.compare(ours, known_orbits.read([written(tmp_path / "truth.oem", truth)]))
    np.testing.assert_allclose(
        table[["sigma_r", "sigma_s", "sigma_w"]], np.tile(SIGMA, (len(T), 1)), rtol=1e-4
    )
    inside = [np.mean(table["ellipsoid"] <= level) for level in (0.5, 0.9)]
    np.testing.assert_allclose(inside, [0.5, 0.9], atol=0.1)
    assert f"the 90 % ellipsoid contains {100 * inside[1]:.0f} %" in comparison.summary(table)


SHEARED = np.array([[1.0, 99.0, 0.01], [99.0, 1e4, -99.0], [0.01, -99.0, 1.0]])
"""Correlations within 1 whose ellipsoid is none: its least eigenvalue is below 0."""


@pytest.mark.parametrize("spread", [np.zeros((3, 3)), np.diag([1.0, 0.0, 1.0]), SHEARED], ids=str)
def test_a_covariance_that_is_no_ellipsoid_has_no_shares(spread, truth, tmp_path, caplog):
    covariances = np.zeros((len(T), 6, 6))
    covariances[:, :3, :3], covariances[:, 3:, 3:] = spread, np.eye(3)
    ours = known_orbits.read([written(tmp_path / "ours.oem", truth, covariances)])
    table = comparison.compare(ours, known_orbits.read([written(tmp_path / "truth.oem", truth)]))
    assert table["ellipsoid"].isna().all()
    assert f"covariances not positive definite, without an ellipsoid: {len(T)}" in caplog.text
    assert "ellipsoid" not in comparison.summary(table)


@pytest.mark.parametrize(
    ("one", "other", "are_two"),
    [
        ("1998-067A", "1999-025B", True),
        ("1998-067A", "98067A", False),
        ("25544", "44714", True),
        ("", "25544", False),
    ],
)
def test_two_objects_are_told(one, other, are_two, truth, tmp_path, caplog):
    orbits = []
    for word in (one, other):
        segment = Ephemeris("ONE", T, truth, identity=ObjectId.of("ONE", word))
        oem.write(tmp_path / "one.oem", [segment], epoch=RUN)
        orbits.append(known_orbits.read([tmp_path / "one.oem"]))
    assert len(comparison.compare(*orbits)) == len(T)
    assert ("compare: expected orbits of one object, got" in caplog.text) == are_two


def in_formats(states, tmp_path):
    """The orbit as SP3 without velocities, as CPF, and as CSV of points."""
    orientation = environment()["earth_orientation"]
    fixed = orbit_files.in_itrf(states, T, orientation)
    points = pd.DataFrame(states[:, :3] / 1e3, columns=[f"{axis}_gcrf_km" for axis in "xyz"])
    points.insert(0, "utc", oem.ccsds.utc_texts(RUN, T))
    points.to_csv(tmp_path / "points.csv", index=False)
    return {
        "SP3": orbit_files.sp3(tmp_path / "orbit.sp3", T, fixed, velocities=False),
        "CPF": orbit_files.cpf(tmp_path / "orbit.cpf", T, fixed),
        "OEM in ITRF": orbit_files.oem(tmp_path / "itrf.oem", [(T, fixed)], frame="ITRF2014"),
        "CSV": tmp_path / "points.csv",
    }


@pytest.mark.parametrize("kind", ["SP3", "CPF", "OEM in ITRF", "CSV"])
def test_every_format_is_the_same_orbit(truth, tmp_path, kind):
    path = in_formats(truth, tmp_path)[kind]
    ours = known_orbits.read([written(tmp_path / "ours.oem", truth)])
    for pair in ((ours, known_orbits.read([path])), (known_orbits.read([path]), ours)):
        table = comparison.compare(*pair)
        assert len(table) == len(T)
        assert table["distance"].max() < 0.02


def test_a_stray_state_is_told_by_its_file(truth, tmp_path):
    stray = truth.copy()
    stray[60, 0] += 1e5
    ours = known_orbits.read([written(tmp_path / "ours.oem", stray)])
    said = refusal(comparison.compare, ours, known_orbits.read([written(tmp_path / "truth.oem", truth)]))
    assert "ours.oem: expected velocities that lead from position to position, got 100 km off at" in said


def test_tables_with_states_are_read_and_no_others(truth, tmp_path):
    table = pd.DataFrame(truth, columns=STATE_COLUMNS).assign(t=T)
    write_table(tmp_path / "truth.parquet", table, "truth", metadata={"epoch": RUN})
    orbit = known_orbits.read([tmp_path / "truth.parquet"])
    np.testing.assert_allclose(orbit.to_pandas()[STATE_COLUMNS], truth)
    np.testing.assert_allclose(orbit.state(datetime.fromisoformat(RUN) + timedelta(minutes=1)), truth[1])
    write_table(tmp_path / "other.parquet", SCHEMAS["tracking"].empty(), "tracking", metadata={"epoch": RUN})
    refused = refusal(known_orbits.read, [tmp_path / "other.parquet"])
    assert "expected a table of truth, corrected, got one of tracking" in refused


def test_velocities_of_another_unit_are_refused(truth, tmp_path):
    fixed = orbit_files.in_itrf(truth, T, environment()["earth_orientation"])
    fixed[:, 3:] *= 10.0
    orbit = known_orbits.read([orbit_files.sp3(tmp_path / "orbit.sp3", T, fixed)])
    assert "orbit.sp3: expected velocities that lead from position to position" in refusal(orbit.at, T)


def test_of_sets_the_nearest_flies(tmp_path, caplog):
    sets = history([0.0, 1.0, 2.0], ahead={1.0: 1000.0})
    (tmp_path / "late.tle").write_text(tle_text(sets))
    (tmp_path / "first.tle").write_text(tle_text(sets.iloc[:1]))
    both = [known_orbits.read([tmp_path / name]) for name in ("first.tle", "late.tle")]
    table = comparison.compare(*both)
    assert len(table) == 7 * 1440
    before, after = table[table["hours"] < 11.9], table[table["hours"] > 12.1]
    assert before["distance"].max() < 1e-3
    np.testing.assert_allclose(after["s"], -1000.0, atol=30.0)
    assert "late.tle ends on" in caplog.text
    assert "SGP4 propagates its newest set, up to 5.0 d" in caplog.text


def test_the_command_writes_and_prints(truth, tmp_path, capsys):
    paths = [
        written(tmp_path / "ours.oem", moved(truth, [0.0, 300.0, 0.0])),
        written(tmp_path / "t.oem", truth),
    ]
    for suffix in ("csv", "json", "parquet"):
        assert cli.main(["compare", *map(str, paths), "-o", str(tmp_path / f"out.{suffix}")]) == 0
        assert " 300 " in capsys.readouterr().out
    tables = [
        pd.read_csv(tmp_path / "out.csv"),
        pd.DataFrame(json.loads((tmp_path / "out.json").read_text())["rows"]),
        read_table(tmp_path / "out.parquet", "comparison"),
    ]
    for table in tables:
        np.testing.assert_allclose(table["s"], 300.0, rtol=1e-6)


def test_orbits_of_other_times_and_objects_are_refused(truth, tmp_path):
    ours = known_orbits.read([written(tmp_path / "ours.oem", truth)])
    (tmp_path / "sets.tle").write_text(tle_text(history([100.0])) + tle_text(history([100.0]), number=7))
    assert "expected --object for one of several objects, got 7, 25544" in refusal(
        known_orbits.read, [tmp_path / "sets.tle"]
    )
    assert "sets.tle: expected one object 8, got" in refusal(known_orbits.read, [tmp_path / "sets.tle"], "8")
    with pytest.raises(InputError, match=r"expected two orbits of the same time, got .*ours"):
        comparison.compare(ours, known_orbits.read([tmp_path / "sets.tle"], "7"))


def test_fragments_of_one_name_that_begin_together_are_told_apart(truth, tmp_path):
    """Three objects of one name and one beginning: each query gives its own states and covariances."""
    ids = ["1999-025AAA", "1999-025BBB", "1999-025CCC"]
    shifted = [moved(truth, [0.0, 1e3 * k, 0.0]) for k in range(3)]
    spreads = [np.tile(np.eye(6) * (k + 1.0), (len(T), 1, 1)) for k in range(3)]
    segments = [
        Ephemeris("FENGYUN 1C DEB", T, states, T, spread, "RSW", identity=ObjectId.of("FENGYUN 1C DEB", one))
        for one, states, spread in zip(ids, shifted, spreads, strict=True)
    ]
    path = tmp_path / "three.oem"
    oem.write(path, segments, epoch=RUN)
    for k, one in enumerate(ids):
        orbit = known_orbits.read([path], one)
        assert orbit.identity.designator == one
        np.testing.assert_allclose(orbit.at(orbit.t), shifted[k], atol=1e-6)
        np.testing.assert_allclose(orbit.covariances(orbit.t), spreads[k], atol=1e-9)
    told = refusal(known_orbits.read, [path], "fengyun 1c deb")
    assert "expected one satellite fengyun 1c deb, got FENGYUN 1C DEB (1999-025AAA), FENGYUN" in told


def test_two_objects_of_one_name_are_not_one_orbit(truth, tmp_path):
    paths = [tmp_path / "a.oem", tmp_path / "b.oem"]
    for path, one, t in zip(paths, ("1999-025A", "1999-025B"), (T, T + 1e4), strict=True):
        oem.write(path, [Ephemeris("DEB", t, truth, identity=ObjectId.of("DEB", one))], epoch=RUN)
    told = refusal(known_orbits.read, paths)
    assert "b.oem: expected satellite DEB (1999-025A), as in" in told
    assert told.endswith("got DEB (1999-025B)")


def test_covariances_along_the_velocity_are_turned(truth, tmp_path):
    """On an eccentric orbit T of TNW is not S of RSW; N points down where the orbit is level."""
    states = truth * [1.0, 1.0, 1.0, 1.2, 1.2, 1.2]
    orbit = kepler(states[0] + [0.0, 0.0, 0.0, 500.0, 0.0, 0.0], 0.0, T)
    tnw = np.tile(np.diag([400.0, 9.0, 1.0, 0.04, 0.01, 0.01]), (len(T), 1, 1))
    path = written(tmp_path / "tnw.oem", orbit, tnw)
    path.write_text(path.read_text().replace("COV_REF_FRAME = RSW", "COV_REF_FRAME = TNW"))
    found = known_orbits.read([path]).covariances(known_orbits.read([path]).t)
    along = orbit[:, 3:] / np.linalg.norm(orbit[:, 3:], axis=1)[:, None]
    across = np.cross(orbit[:, :3], orbit[:, 3:])
    across /= np.linalg.norm(across, axis=1)[:, None]
    in_gcrf = rsw_rotation(orbit).transpose(0, 2, 1) @ found[:, :3, :3] @ rsw_rotation(orbit)
    for axis, variance in ((along, 400.0), (np.cross(across, along), 9.0), (across, 1.0)):
        np.testing.assert_allclose(np.einsum("ni,nij,nj->n", axis, in_gcrf, axis), variance, rtol=1e-6)


def test_three_orbits_stand_side_by_side(truth, tmp_path, capsys):
    """The truth is the last; what is of another format before it is compared with it, too."""
    states = truth + np.array([3.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    for name, moved in (("mine", states), ("truth", truth)):
        table = pd.DataFrame(moved, columns=STATE_COLUMNS).assign(t=T)
        write_table(tmp_path / f"{name}.parquet", table, "truth", metadata={"epoch": RUN})
    lines = ["x_gcrf_m,y_gcrf_m,z_gcrf_m,utc"]
    moved_up = truth[:, :3] + [0.0, 0.0, 40.0]
    lines += [",".join([*map(str, row), utc]) for row, utc in zip(moved_up, utc_texts(RUN, T), strict=True)]
    (tmp_path / "sets.csv").write_text("\n".join(lines) + "\n")
    paths = [str(tmp_path / name) for name in ("mine.parquet", "sets.csv", "truth.parquet")]
    assert cli.main(["compare", *paths]) == 0
    head, names, *rows = capsys.readouterr().out.partition("root mean square distances [m]")[2].splitlines()
    assert head.startswith(f" from {paths[2]}, from 20")
    assert names.split() == ["from_h", *paths[:2]]
    assert {tuple(row.split()[1:]) for row in rows} == {("3.00", "40")}
