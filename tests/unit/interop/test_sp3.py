"""SP3: columns, time systems, satellites, what is absent, and what is refused."""

import numpy as np
import pytest
from orbit_files import AHEAD_OF_UTC, flagged, sp3 as written
from support import EPOCH, edited, refusal, refusals

from opml.base.errors import InputError
from opml.interop.orbit_arcs import contents
from opml.interop.orbit_formats import sp3

T = np.array([0.0, 60.0, 120.0, 180.0])
STATES = np.random.default_rng(1).uniform(-7e6, 7e6, (4, 6)) * np.repeat([1.0, 1e-3], 3)


def read(path, satellite=None):
    (arc,) = sp3.read(path, contents(path), epoch=EPOCH, satellite=satellite)
    return arc


@pytest.mark.parametrize("name", ["orbit.sp3", "orbit.sp3.gz"])
@pytest.mark.parametrize("version", ["c", "d"])
@pytest.mark.parametrize("scale", AHEAD_OF_UTC)
def test_what_was_written_is_read(tmp_path, name, version, scale):
    arc = read(written(tmp_path / name, T, STATES, scale=scale, version=version))
    np.testing.assert_array_equal(arc.t, T)
    np.testing.assert_allclose(arc.positions, STATES[:, :3], rtol=0, atol=0.6e-3)
    np.testing.assert_allclose(arc.velocities, STATES[:, 3:], rtol=0, atol=0.6e-7)
    assert (arc.satellite, arc.frame, arc.realisation, arc.scale) == ("L47", "ITRF", "IGS14", scale)
    assert arc.lines.tolist() == [24, 27, 30, 33]


def test_a_file_without_velocities_has_none(tmp_path):
    arc = read(written(tmp_path / "orbit.sp3", T, STATES, velocities=False))
    np.testing.assert_allclose(arc.positions, STATES[:, :3], rtol=0, atol=0.6e-3)
    assert np.isnan(arc.velocities).all()


@pytest.mark.parametrize(("number", "messages"), [(1.0, []), (0.1, ["taken for m/s"])])
def test_velocities_in_metres_are_seen_by_the_positions(tmp_path, caplog, number, messages):
    """DORIS orbits of 2008 have velocities in m/s where the format has dm/s."""
    speed = np.array([3e3, -5e3, 4e3])
    straight = np.column_stack([7e6 + T[:, None] * speed, np.tile(number * speed, (4, 1))])
    arc = read(written(tmp_path / "orbit.sp3", T, straight))
    np.testing.assert_allclose(arc.velocities, np.tile(speed, (4, 1)))
    assert [said for said in messages if said in caplog.text] == messages
    assert len(caplog.messages) == len(messages)


def test_one_of_several_satellites_is_chosen(tmp_path):
    path = written(tmp_path / "two.sp3", T, STATES, satellite=None)
    np.testing.assert_allclose(read(path, "L02").positions, STATES[:, :3] + 1e5, rtol=0, atol=0.6e-3)
    assert "expected the name of one of its satellites, got L01, L02" in refusal(read, path)
    assert "expected satellite L03, got L01, L02" in refusal(read, path, "L03")


@pytest.mark.parametrize("absent", ["0.000000", "999999.999999"])
def test_bad_and_absent_values_are_left_out(tmp_path, absent):
    path = written(tmp_path / "orbit.sp3", T, STATES)
    lines = path.read_text().splitlines()
    for number, mark in ((26, "PL47"), (30, "VL47")):
        assert lines[number].startswith(mark)
        lines[number] = f"{mark}{absent:>14}{absent:>14}{absent:>14} 999999.999999"
    path.write_text("\n".join(lines))
    arc = read(path)
    assert arc.t.tolist() == [0.0, 120.0, 180.0]
    assert np.isfinite(arc.velocities).all(axis=1).tolist() == [True, False, True]


def test_predicted_positions_do_not_count(tmp_path, caplog):
    path = written(tmp_path / "orbit.sp3", T, STATES)
    arc = read(flagged(flagged(path, 26, "P", 79), 29, "M", 78))
    assert (arc.t.tolist(), arc.burns) == ([0.0, 120.0, 180.0], [90.0])
    assert caplog.messages == [f"{path}: predicted positions left out: 1"]
    lines = path.read_text().splitlines()
    path.write_text("\n".join(f"{line:<79.79}P" if line.startswith("PL47") else line for line in lines))
    with pytest.raises(InputError, match=r"expected a position of L47, got none: .* predicted ones do not"):
        read(path)


@pytest.mark.parametrize("frame", ["IGS14", "IGb14", "IGS20", "ITRF", "ITR97", "SLR08", "WGS84", "ECF"])
def test_realisations_of_the_itrf_are_taken_for_it(tmp_path, frame):
    arc = read(written(tmp_path / "orbit.sp3", T, STATES, frame=frame))
    assert (arc.frame, arc.realisation) == ("ITRF", frame)


@pytest.mark.parametrize(("old", "new", "message"), refusals("sp3"))
def test_what_is_malformed_is_named_by_file_and_line(tmp_path, old, new, message):
    path = edited(written(tmp_path / "orbit.sp3", T, STATES), old, new)
    assert refusal(read, path).startswith(f"{path}: {message}")


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            lambda lines: [*lines[:25], lines[23], *lines[25:]],
            "line 26: expected an epoch before this line, got PL47",
        ),
        (
            lambda lines: [*lines[:22], lines[23], *lines[22:]],
            "line 23: expected an epoch before this line, got PL47",
        ),
        (lambda lines: [*lines[:-2], lines[-2][:44]], "line 34: expected digits up to column 46, got VL47"),
        (
            lambda lines: [line.replace("PL47", "PL48") for line in lines],
            "expected a position of L47, got none",
        ),
    ],
    ids=["twice in an epoch", "before an epoch", "cut within a number", "of another satellite"],
)
def test_positions_out_of_place_are_named_by_line(tmp_path, changed, message):
    path = written(tmp_path / "orbit.sp3", T, STATES)
    path.write_text("\n".join(changed(path.read_text().splitlines())))
    assert message in refusal(read, path)


def test_a_file_packed_and_damaged_is_refused(tmp_path):
    path = written(tmp_path / "orbit.sp3.gz", T, STATES)
    for damaged in (path.read_bytes()[:-9], path.read_bytes()[:30] + b"?" * 9 + path.read_bytes()[39:]):
        path.write_bytes(damaged)
        assert "expected a file that is whole, got" in refusal(read, path)
