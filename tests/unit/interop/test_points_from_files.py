"""Points of one orbit in every format, frame and time system, and CSVs of which no points can be made."""

import gzip
from datetime import datetime

import numpy as np
import pytest
from orbit_files import AHEAD_OF_UTC, cpf, flagged, in_itrf, oem, sp3
from support import EPOCH, refusals

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.simulate.truth import initial_state
from opml.interop import ccsds, fixes_csv, points_from_files
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.points_from_files import FixSettings
from opml.orbits.elements import rsw_rotation
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, STATE

PLACES = FixSettings(sigma_m=(3.0, 6.0, 4.0), every_s=0.0)
MOVING = PLACES.evolve(sigma_mps=(0.03, 0.06, 0.04))


@pytest.fixture(scope="module")
def t():
    return np.arange(0.0, 7200.0, 60.0)


@pytest.fixture(scope="module")
def states(kepler_model, iss, t):
    """States on a circle (n, 6), as fast as the paper's RSO."""
    start = initial_state(iss, kepler_model.gm)
    radius = np.linalg.norm(start[:3])
    up, across = rsw_rotation(start[None])[0][[0, 2]]
    ahead, rate = np.cross(across, up), np.sqrt(kepler_model.gm / radius**3)
    cosine, sine = np.cos(rate * t)[:, None], np.sin(rate * t)[:, None]
    place, motion = cosine * up + sine * ahead, cosine * ahead - sine * up
    return radius * np.hstack([place, rate * motion])


@pytest.fixture
def read(tmp_path, earth_orientation):
    """Points of files that are written by a function of `orbit_files`, or by `csv`."""

    def read(write, *args, sampling=PLACES, duration=DAY, **options):
        path = write(tmp_path / "orbit", *args, **options)
        return points_from_files.read(OrbitFiles([path], EPOCH, duration), earth_orientation, sampling)

    return read


def csv(path, t, states, *, frame="itrf", scale="utc", unit="m", velocities=False, extra=()):
    """Write states (n, 6) [m, m/s] in the frame as CSV; extra: columns and the value that they have."""
    names = [f"{axis}_{frame}_{unit}{'ps' * axis.startswith('v')}" for axis in STATE]
    count = 6 if velocities else 3
    lines = [",".join([scale, *names[:count], *(name for name, _ in extra)])]
    factor = 1e-3 if unit == "km" else 1.0
    texts = ccsds.utc_texts(EPOCH, t + AHEAD_OF_UTC[scale.upper()])
    for text, state in zip(texts, states, strict=True):
        numbers = [repr(float(factor * value)) for value in state[:count]]
        lines.append(",".join([text, *numbers, *(str(value) for _, value in extra)]))
    path.write_text("\n".join(lines) + "\n")
    return path


def test_what_files_tell_beside_points(tmp_path, t, states):
    orbit = flagged(sp3(tmp_path / "orbit.sp3", t, states), 23 + 3, "M", 78)
    files = [orbit, cpf(tmp_path / "orbit.cpf", t, states), csv(tmp_path / "orbit.csv", t, states)]
    told = [points_from_files.identity_and_burns(OrbitFiles([path], EPOCH, DAY)) for path in files]
    assert told[0] == (ObjectId("L47"), [Manoeuvre(30.0, known=30.0)])
    assert told[1:] == [(ObjectId("larets", number=27944), []), (UNKNOWN, [])]


@pytest.mark.parametrize("scale", ["utc", "gps", "tai"])
@pytest.mark.parametrize("frame", ["itrf", "gcrf"])
@pytest.mark.parametrize("unit", ["m", "km"])
def test_frames_time_systems_and_units_of_a_csv_give_the_same_points(
    read, t, states, earth_orientation, scale, frame, unit
):
    written = in_itrf(states, t, earth_orientation) if frame == "itrf" else states
    points = read(csv, t, written, frame=frame, scale=scale, unit=unit, velocities=True, sampling=MOVING)
    np.testing.assert_allclose(points["t"], t, atol=1e-6)
    assert np.abs(points[STATE] - states).to_numpy().max(axis=0) == pytest.approx(0.0, abs=1e-4)
    assert (points[FIX_SIGMAS].to_numpy() == MOVING.sigmas).all()


@pytest.mark.parametrize("write", [sp3, cpf])
def test_files_of_orbits_give_the_points_of_their_nodes(read, t, states, earth_orientation, write):
    points = read(write, t, in_itrf(states, t, earth_orientation))
    assert np.abs(points[STATE[:3]] - states[:, :3]).to_numpy().max() < 2e-3
    assert points[FIX_SIGMAS[3:]].isna().all(axis=None)
    assert (points[FIX_SIGMAS[:3]].to_numpy() == PLACES.sigmas).all()


def test_velocities_of_an_orbit_count_where_their_sigmas_are_told(read, t, states):
    points = read(oem, [(t[:50], states[:50]), (t[40:], states[40:])], frame="GCRF", sampling=MOVING)
    np.testing.assert_allclose(points["t"], t)  # each once, although segments overlap
    assert np.abs(points[STATE] - states).to_numpy().max() < 1e-5


def test_sigmas_of_a_csv_replace_those_that_are_told(read, t, states):
    extra = [("sigma_r_m", 1.5), ("-", "3D"), ("sigma_s_km", 0.02), ("sigma_w_m", 2)]
    points = read(csv, t, states, frame="gcrf", extra=extra)
    assert (points[FIX_SIGMAS[:3]] == [1.5, 20.0, 2.0]).all(axis=None)


def test_points_are_thinned_by_steps_since_the_epoch_and_cut_to_the_run(read, t, states):
    points = read(csv, t + 30.0, states, frame="gcrf", sampling=PLACES.evolve(every_s=600.0), duration=3000.0)
    assert points["t"].tolist() == [30.0, 630.0, 1230.0, 1830.0, 2430.0]


def test_a_file_of_another_time_is_told(tmp_path, t, states, caplog):
    """The clock of the second receiver began anew: 1024 weeks early."""
    paths = [csv(tmp_path / name, at, states) for name, at in (("now", t), ("early", t - 1024 * 7 * DAY))]
    points_from_files.check(OrbitFiles(paths, EPOCH, DAY), PLACES)
    (message,) = caplog.messages
    assert message == (
        f"files without a point from {EPOCH}.000000 to 2016-09-29T12:09:45.000000: 1, as {paths[1]}, "
        "of 1997-02-12T12:09:51.000000 "
        "to 1997-02-12T14:08:51.000000"
    )


GOOD = """\
utc,x_gcrf_m,y_gcrf_m,z_gcrf_m
2016-09-28T12:10:00,7000000.0,0.0,0.0
2016-09-28T12:11:00,6990000.0,450000.0,0.0
"""
MOVED = """\
utc,x_gcrf_m,y_gcrf_m,z_gcrf_m,vx_gcrf_mps,vy_gcrf_mps,vz_gcrf_mps,sigma_vr_mps,sigma_vs_mps,sigma_vw_mps
2016-09-28T12:10:00,7000000.0,0.0,0.0,-167,7500,0,1,1,1
2016-09-28T12:11:00,6990000.0,450000.0,0.0,-167,7500,0,1,1,1
"""

TEXTS = {"good": GOOD, "moved": MOVED}
ENDLESS = pytest.param(
    *("good", "450000", "9" * 200_000, "line 3: expected cells of CSV, got field larger"), id="endless cell"
)


@pytest.mark.parametrize(("text", "old", "new", "message"), [*refusals("points"), ENDLESS])
def test_a_wrong_csv_is_told_in_one_line(tmp_path, text, old, new, message):
    path = tmp_path / "orbit.csv"
    path.write_text(TEXTS[text].replace(old, new))
    with pytest.raises(InputError, match=message) as told:
        points_from_files.check(OrbitFiles([path], EPOCH, DAY), MOVING)
    assert str(path) in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (GOOD.encode("utf-16"), "expected CSV in UTF-8 text, got none"),
        (bytes(range(256)), r"expected an orbit \(OEM, .*\), got bytes that are no text in UTF-8"),
        (GOOD.encode() + b"\xff", "expected CSV in UTF-8 text, got none"),
        (
            gzip.compress(GOOD.encode(), mtime=0)[:-9],
            "expected a file that is whole, got Compressed file ended",
        ),
        (
            gzip.compress(b"\n" * 60_000_000, mtime=0),
            "expected a file that is whole, got a gzip of more than 200 times its size",
        ),
    ],
    ids=["UTF-16", "every byte", "a byte", "cut gzip", "gzip of blank lines"],
)
def test_bytes_that_are_no_csv_are_told_in_one_line(tmp_path, content, message):
    path = tmp_path / "orbit.csv"
    path.write_bytes(content)
    with pytest.raises(InputError, match=f"{path}: {message}"):
        points_from_files.check(OrbitFiles([path], EPOCH, DAY), PLACES)


def test_headings_in_use_give_the_same_points(tmp_path, t, states):
    """Of receivers, reports of GMAT and spreadsheets."""
    utc = ccsds.utc_texts(EPOCH, t)
    metres, zulu = states, [f"{text}Z" for text in utc]
    months = [datetime.fromisoformat(text).strftime("%d %b %Y %H:%M:%S.%f") for text in utc]
    headings = [
        (";", "epoch;x_gcrf_km;y_gcrf_km;z_gcrf_km", zulu, 1e-3 * metres[:, :3]),
        ("\t", "UTC\tPX_ICRF (m)\tPY_ICRF (m)\tPZ_ICRF (m)", utc, metres[:, :3]),
        (",", "t,x_gcrf,y_gcrf,z_gcrf", zulu, 1e-3 * metres[:, :3]),
        (",", "time [utc],pos_x_gcrf,pos_y_gcrf,pos_z_gcrf", utc, metres[:, :3]),
        (
            "   ",
            "Sat.UTCGregorian   " + "   ".join(f"Sat.ICRF.{a.upper()}" for a in STATE),
            months,
            1e-3 * metres,
        ),
        (
            ",",
            "utc," + ",".join(f"{a}_gcrf ({'km/sec' if 'v' in a else 'km'})" for a in STATE),
            utc,
            1e-3 * metres,
        ),
    ]
    unix = [f"{datetime.fromisoformat(text).timestamp():.6f}" for text in zulu]
    headings += [
        (",", "# made by a receiver\n# utc,x_gcrf_m,y_gcrf_m,z_gcrf_m", utc, metres[:, :3]),
        (",", "unix_time,x_gcrf_m,y_gcrf_m,z_gcrf_m", unix, metres[:, :3]),
        (";", "unix_s;x_gcrf_m;y_gcrf_m;z_gcrf_m", unix, metres[:, :3]),
    ]
    path = tmp_path / "orbit.csv"
    for separator, first, times, rows in headings:
        lines = [
            separator.join([time, *map(repr, row.tolist())]) for time, row in zip(times, rows, strict=True)
        ]
        if separator == ";":
            lines = [line.replace(".", ",") for line in lines]
        path.write_text("\n".join([first, *lines]))
        assert fixes_csv.matches(path.read_bytes()), first
        (arc,) = fixes_csv.read(path, path.read_bytes(), epoch=EPOCH)
        assert (arc.frame, arc.scale) == ("GCRF", "UTC"), first
        np.testing.assert_allclose(arc.t, t, atol=1e-6)
        np.testing.assert_allclose(arc.positions, metres[:, :3], rtol=1e-12)
        if rows.shape[1] == len(STATE):
            np.testing.assert_allclose(arc.velocities, metres[:, 3:], rtol=1e-12)


def test_headings_in_blanks_are_no_mean_elements():
    assert fixes_csv.matches(b"utc x_itrf_m y_itrf_m z_itrf_m\n")
    assert fixes_csv.matches(b"Sat.UTCGregorian   Sat.EarthTOD.X   Sat.EarthTOD.Y   Sat.EarthTOD.Z\n")
    assert not fixes_csv.matches(b'"an open quote; x; y; z\n')
    assert not fixes_csv.matches(b"SPACE X 1 DEB\n1 00005U 58002B   00179.78495062  .00000023  00000-0\n")


def test_a_unit_that_is_seen_by_the_radius_is_told(tmp_path, caplog):
    path = tmp_path / "orbit.csv"
    path.write_text(GOOD.replace("_m", ""))
    points_from_files.check(OrbitFiles([path], EPOCH, DAY), PLACES)
    why = "no column names a unit, and positions are 7.0022e+06 long"
    assert caplog.messages == [f"{path}: lengths are taken as m: {why}"]


def test_files_of_one_rso_have_one_format(tmp_path, t, states):
    first, second = tmp_path / "a.csv", tmp_path / "b.oem"
    first.write_text(GOOD)
    oem(second, [(t, states)])
    with pytest.raises(InputError, match=r"b.oem: expected CSV of points, as .*a.csv, got OEM"):
        points_from_files.check(OrbitFiles([first, second], EPOCH, DAY), PLACES)
    second.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"b.oem: expected an orbit .* got bytes that are no text"):
        points_from_files.check(OrbitFiles([first, second], EPOCH, DAY), PLACES)
