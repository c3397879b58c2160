"""OEM: what is written comes back bit for bit, and what is malformed is named by file and line."""

import re

import erfa
import numpy as np
import pytest
from hypothesis import given, strategies as st
from support import EPOCH, edited, refusal, refusals

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.propagator import Propagator
from opml.catalog.simulate import truth
from opml.interop import ccsds, known_orbits, oem
from opml.interop.ephemeris import Ephemeris
from opml.orbits.density_error import DensityErrors
from opml.tables import STATE

DOUBLES = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e290, max_value=1e290)


@pytest.fixture(scope="module")
def orbit(kepler_model, iss):
    """Ten minutes of the paper's RSO."""
    return truth.simulate(Propagator(kepler_model, iss), duration=600.0, step=20.0)


@pytest.fixture
def message(orbit, tmp_path):
    path = tmp_path / "iss.oem"
    oem.write(path, oem.truth_segments(orbit, rso="iss"), epoch=EPOCH)
    return path


def arcs(path, **satellite):
    return oem.read(path, path.read_bytes(), epoch=EPOCH, **satellite)


@given(DOUBLES, st.sampled_from([-6, -3, 0]))
def test_a_number_keeps_every_bit(value, power):
    back = ccsds.scaled("", 1, ccsds.number_text(value, power), -power)
    assert np.float64(back).tobytes() == np.float64(value).tobytes()


@given(st.lists(DOUBLES, max_size=4), st.lists(st.floats(-1e9, 1e9), max_size=4), st.sampled_from([-6, -3]))
def test_many_numbers_have_the_texts_of_each(values, lengths, power):
    numbers = np.array([*values, *lengths, 5.0, -7612.0, 512.25], float)
    assert ccsds.number_texts(numbers, power) == [ccsds.number_text(value, power) for value in numbers]


@given(st.lists(st.integers(-(10**13), 10**13), min_size=1, max_size=5))
def test_times_come_back_to_the_microsecond_across_leap_seconds(microseconds):
    t = np.array(microseconds) / 1e6
    back = ccsds.times("", range(len(t)), ccsds.utc_texts(EPOCH, t), epoch=EPOCH, scale="UTC")
    np.testing.assert_array_equal(back, t)


def test_the_leap_second_of_2016_has_a_name():
    midnight = 94 * DAY + (DAY - 43785.0)  # 2016-12-31T24:00:00 if there were none
    assert ccsds.utc_texts(EPOCH, [midnight]) == ["2016-12-31T23:59:60.000000"]


def test_truth_comes_back_bit_for_bit(orbit, message):
    (back,) = known_orbits.segments(message, epoch=EPOCH)
    np.testing.assert_array_equal(back.t, orbit["t"])
    np.testing.assert_array_equal(back.states, orbit[list(STATE)])


def test_byte_order_marks_and_the_header_of_version_3_are_passed_over(orbit, message):
    edited(message, "CCSDS_OEM_VERS = 2.0", "CCSDS_OEM_VERS = 3.0\nCLASSIFICATION = public\nMESSAGE_ID = 7")
    message.write_text("\ufeff" + message.read_text(encoding="utf-8"), encoding="utf-8")
    (back,) = known_orbits.segments(message, epoch=EPOCH)
    np.testing.assert_array_equal(back.states, orbit[list(STATE)])


@pytest.fixture
def of_estimates(tmp_path):
    """A message of two states with their covariances, 200 s apart."""
    generator, t = np.random.default_rng(1), np.array([0.0, 200.0])
    roots = generator.normal(size=(2, 6, 6))
    covariances = roots @ roots.transpose(0, 2, 1)
    states = generator.normal(size=(2, 6))
    oem.write(tmp_path / "e.oem", [Ephemeris("iss", t, states, t, covariances)], epoch=EPOCH)
    return tmp_path / "e.oem", states, covariances


def test_covariances_come_back_bit_for_bit(of_estimates):
    path, states, covariances = of_estimates
    (back,) = known_orbits.segments(path, epoch=EPOCH)
    assert back.t.tolist() == back.covariance_t.tolist() == [0.0, 200.0]
    np.testing.assert_array_equal(back.states, states)
    lower = np.tril_indices(6)
    np.testing.assert_array_equal(back.covariances[:, *lower], covariances[:, *lower])


def test_other_frames_and_time_systems_are_turned_to_ours(message, orbit):
    edited(message, "REF_FRAME = GCRF", "REF_FRAME = EME2000")
    (back,) = known_orbits.segments(message, epoch=EPOCH)
    bias = np.array(erfa.bp06(2451545.0, 0.0)[0])  # GCRS to mean J2000
    np.testing.assert_allclose(back.states[:, :3] @ bias.T, orbit[["x", "y", "z"]], rtol=0, atol=1e-8)
    assert 0.1 < np.linalg.norm(back.states[0, :3] - orbit.loc[0, ["x", "y", "z"]].to_numpy(float)) < 1.0
    edited(message, "TIME_SYSTEM = UTC", "TIME_SYSTEM = TAI")
    assert known_orbits.segments(message, epoch=EPOCH)[0].t[0] == -36.0
    edited(message, "TIME_SYSTEM = TAI", "TIME_SYSTEM = TT")
    assert known_orbits.segments(message, epoch=EPOCH)[0].t[0] == -68.184
    edited(message, "TIME_SYSTEM = TT", "TIME_SYSTEM = GPS")
    assert known_orbits.segments(message, epoch=EPOCH)[0].t[0] == -17.0


def test_days_of_the_year_zulus_and_accelerations_are_read(message, orbit):
    text = message.read_text().replace("2016-09-28T", "2016-272T")
    lines = [f"{line} 0 0 0" if line.startswith("2016") else line for line in text.splitlines()]
    lines[16] = lines[16].replace(" ", "Z ", 1)
    message.write_text("\n".join(lines))
    (back,) = known_orbits.segments(message, epoch=EPOCH)
    np.testing.assert_array_equal(back.t, orbit["t"])


@pytest.mark.parametrize(("old", "new", "line"), refusals("oem"))
def test_what_is_malformed_is_named_by_file_and_line(message, old, new, line):
    edited(message, old, new)
    assert refusal(known_orbits.segments, message, epoch=EPOCH).startswith(f"{message}: {line}")


@pytest.fixture
def shared_density(tmp_path):
    """A message whose covariances hold an error of density that others share."""
    t = np.array([0.0, 60.0, 120.0])
    states = np.tile([7e6, 0.0, 0.0, 0.0, 7.5e3, 0.0], (3, 1))
    density = DensityErrors(0.1, t[[0, 2]], np.arange(12.0).reshape(2, 6))
    covariances = np.repeat(1e6 * np.eye(6)[None], 3, axis=0)
    segment = Ephemeris("iss", t, states, t, covariances, covariance_frame="RSW", density=density)
    path = tmp_path / "shared.oem"
    oem.write(path, [segment], epoch=EPOCH)
    return path, density


def test_an_error_of_density_comes_back(shared_density):
    path, density = shared_density
    (found,) = known_orbits.segments(path, epoch=EPOCH)
    assert found.density.uncertainty == density.uncertainty
    np.testing.assert_array_equal(found.density.sensitivities, density.sensitivities)
    assert found.density.at(60.0).effect == pytest.approx(0.1 * np.arange(3.0, 9.0))
    assert len(found.covariances) == 3


@pytest.mark.parametrize(("old", "new", "expected"), refusals("density_in_oem"))
def test_a_damaged_error_of_density_is_told_by_line(shared_density, old, new, expected):
    path, _ = shared_density
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(InputError, match=rf"shared\.oem: line \d+: expected {expected}"):
        known_orbits.segments(path, epoch=EPOCH)


@pytest.mark.parametrize("text", ["nan", "inf", "1e999", "1_000", "0x1p3", "7,5", "\u0661"])
def test_numbers_have_to_be_finite_and_plain(message, text):
    lines = message.read_text().splitlines()
    lines[16] = " ".join([*lines[16].split()[:-1], text])
    message.write_text("\n".join(lines))
    assert "line 17: expected a finite number, got" in refusal(known_orbits.segments, message, epoch=EPOCH)


@pytest.mark.parametrize(("old", "new", "expected"), refusals("covariances_in_oem"))
def test_a_malformed_covariance_is_named(of_estimates, old, new, expected):
    assert f": expected {expected}" in refusal(
        known_orbits.segments, edited(of_estimates[0], old, new), epoch=EPOCH
    )


def test_the_frame_of_covariances_is_read(of_estimates):
    path, *_ = of_estimates
    path.write_text(path.read_text().replace("COV_REF_FRAME = GCRF", "COV_REF_FRAME = RSW"))
    assert known_orbits.segments(path, epoch=EPOCH)[0].covariance_frame == "RSW"


def test_a_covariance_has_six_rows_that_grow(of_estimates):
    path, *_ = of_estimates
    lines = path.read_text().splitlines()
    third = next(k for k, line in enumerate(lines) if line.startswith("COV_REF_FRAME")) + 3
    path.write_text("\n".join([*lines[:third], *lines[third + 1 :]]))
    expected = f"line {third + 1}: expected row 3 of a covariance's lower triangle"
    assert expected in refusal(known_orbits.segments, path, epoch=EPOCH)


def test_a_cut_file_is_noticed(message):
    text = message.read_text()
    for size in (0, 10, 200, 330):
        message.write_text(text[:size])
        assert "expected" in refusal(known_orbits.segments, message, epoch=EPOCH)


def test_no_file_and_no_text_are_input_errors(tmp_path):
    assert "no such file" in refusal(known_orbits.segments, tmp_path / "none.oem", epoch=EPOCH)
    (tmp_path / "bytes.oem").write_bytes(b"\xff\xfe\x00")
    assert "got bytes that are no text in UTF-8" in refusal(
        known_orbits.segments, tmp_path / "bytes.oem", epoch=EPOCH
    )


def as_nasa(message, frame="EME2000"):
    """The message as NASA writes it: units in words, the useable times, another frame."""
    text = message.read_text().replace("REF_FRAME = GCRF", f"REF_FRAME = {frame}")
    text = text.replace("CENTER_NAME = EARTH", "CENTER_NAME          = Earth")
    message.write_text(text.replace("META_STOP", "USEABLE_START_TIME = 2016-09-28T12:10:00\nMETA_STOP"))
    return message


@pytest.mark.parametrize("frame", ["ITRF", "ITRF2000", "ITRF-97", "itrf2014", "EME2000", "ICRF", "GCRF"])
def test_arcs_keep_the_frame_of_the_message(message, orbit, frame):
    (arc,) = arcs(as_nasa(message, frame))
    assert arc.frame == ("ITRF" if frame.upper().startswith("ITRF") else frame)
    assert (arc.realisation, arc.scale, arc.satellite) == (frame, "UTC", "iss")
    # The first state, at 12:09:45, is outside of the useable times.
    np.testing.assert_array_equal(arc.t, orbit["t"][1:])
    np.testing.assert_array_equal(np.hstack([arc.positions, arc.velocities]), orbit[list(STATE)][1:])
    assert arc.lines.tolist() == list(range(18, 48))


def test_an_arc_per_segment_of_the_object_that_is_wanted(tmp_path, orbit):
    path = tmp_path / "two.oem"
    parts = [("iss", orbit[:11]), ("mir", orbit), ("iss", orbit[11:])]
    segments = [segment for rso, part in parts for segment in oem.truth_segments(part, rso=rso)]
    oem.write(path, segments, epoch=EPOCH)
    assert [len(arc.t) for arc in arcs(path, satellite="ISS")] == [11, 20]
    with pytest.raises(
        InputError, match=r"two\.oem: expected the name of one of its satellites, got iss, mir"
    ):
        arcs(path)
    with pytest.raises(InputError, match=r"two\.oem: expected satellite tiangong, got iss, mir"):
        arcs(path, satellite="tiangong")


def test_messages_in_a_row_are_read_as_their_segments(tmp_path, orbit):
    parts = [oem.truth_segments(rows, rso="iss") for rows in (orbit[:11], orbit[11:])]
    texts = []
    for k, segments in enumerate(parts):
        oem.write(tmp_path / f"{k}.oem", segments, epoch=EPOCH)
        texts.append((tmp_path / f"{k}.oem").read_text())
    path = tmp_path / "joined.oem"
    path.write_text("".join(texts))
    assert [len(arc.t) for arc in arcs(path)] == [11, 20]
    known = [one.known for one in known_orbits.segments(path, epoch=EPOCH)]
    assert known == [parts[0][0].known, parts[1][0].known]  # of each message, by its date of creation
    path.write_text("".join([texts[0], texts[1].replace("VERS = 2.0", "VERS = 9.0")]))
    with pytest.raises(InputError, match=r"joined.oem: line 2\d: expected CCSDS_OEM_VERS = 1.0 or .*= 9"):
        arcs(path)


def test_covariances_outside_the_states_are_told(of_estimates, caplog):
    path, *_ = of_estimates
    arcs(path)
    assert caplog.messages == []
    *_, last = re.findall(r"EPOCH = (\S+)", path.read_text())
    path.write_text(path.read_text().replace(f"EPOCH = {last}", f"EPOCH = 2017{last[4:]}"))
    arcs(path)
    assert caplog.messages == [f"{path}: covariances of times outside those of the states: 1"]


@pytest.mark.parametrize("other", ["TNW", "GCRF", "SEZ"])
def test_covariances_of_a_segment_may_have_axes_of_their_own(of_estimates, other, caplog):
    """Of two covariances of one segment, each is turned as if it were alone, or left out."""
    path, *_ = of_estimates
    text = path.read_text()

    def in_rsw(*frames):
        parts = iter(frames)
        path.write_text(re.sub("(?<=COV_REF_FRAME = )GCRF", lambda _: next(parts), text))
        (segment,) = known_orbits.segments(path, epoch=EPOCH)
        turned = segment.in_rsw(lambda t: segment.states[np.isin(segment.t, t)])
        return turned.covariance_t, turned.covariances

    (t, mixed), (_, rsw), (_, alone) = in_rsw("RSW", other), in_rsw("RSW", "RSW"), in_rsw(other, other)
    assert t.tolist() == [0.0, 200.0][: len(mixed)]
    np.testing.assert_allclose(mixed, [rsw[0], *alone[1:]], rtol=1e-12)
    assert len(mixed) == 1 + (other != "SEZ")
    assert ("covariances left out: 1: expected COV_REF_FRAME" in caplog.text) == (other == "SEZ")


@pytest.mark.parametrize("frame", ["ITRF-97", "RSW_ROTATING", "SEZ"])
def test_an_unknown_frame_of_covariances_costs_these_alone(of_estimates, frame, caplog):
    path, *_ = of_estimates
    path.write_text(path.read_text().replace("COV_REF_FRAME = GCRF", f"COV_REF_FRAME = {frame}"))
    (arc,) = arcs(path)
    assert (arc.t.tolist(), len(arc.covariances)) == ([0.0, 200.0], 0)
    assert ": covariances left out: 2: expected COV_REF_FRAME = GCRF or" in caplog.text


def test_frames_of_date_are_turned_to_ours(message, orbit):
    text = message.read_text()
    turned = {}
    for frame in ("TEME", "TOD"):
        message.write_text(text.replace("REF_FRAME = GCRF", f"REF_FRAME = {frame}"))
        (arc,) = arcs(message)
        assert (arc.frame, arc.realisation) == ("GCRF", frame)
        turned[frame] = arc.positions
    equinoxes = erfa.ee06a(*epochs.tt(EPOCH, 0.0))
    turn = erfa.pnm06a(*epochs.tt(EPOCH, 0.0)).T
    given = orbit[list(STATE[:3])].to_numpy()
    np.testing.assert_allclose(turned["TOD"], given @ turn.T, rtol=0, atol=0.01)
    mean = turn @ erfa.rz(-equinoxes, np.eye(3))
    np.testing.assert_allclose(turned["TEME"], given @ mean.T, rtol=0, atol=2.0)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (r"STOP_TIME.*\n", ""),
        (r"ORIGINATOR.*\n", ""),
        (" = ", "\t=\t"),
        ("GCRF", "gcrf"),
        ("= UTC", "= utc"),
        ("= EARTH", "= Earth"),
        ("META_STOP", "MANEUVERABLE = NO\nREF_FRAME_EPOCH = 2000-01-01T12:00:00\nMETA_STOP"),
        ("META_STOP", "INTERPOLATION = LAGRANGE\nINTERPOLATION_DEGREE = 9\nMETA_STOP"),
        ("\n", "\n\n"),
        ("\n", "\r\n"),
        (r"(?m)^(2016\S+)", r"\1Z"),
        ("OBJECT_NAME = .*", "OBJECT_NAME = ČIBIS 中"),
    ],
    ids=str,
)
def test_what_a_message_may_have_otherwise_changes_no_state(message, orbit, old, new):
    message.write_text(re.sub(old, new, message.read_text()), newline="")
    (arc,) = arcs(message)
    np.testing.assert_array_equal(arc.positions, orbit[list(STATE[:3])].to_numpy())


@pytest.mark.parametrize("frame", ["TEME", "TOD"])
def test_a_frame_of_date_may_be_of_another_epoch(message, frame):
    """Twenty years of precession are a third of a degree."""
    edited(message, "REF_FRAME = GCRF", f"REF_FRAME = {frame}")
    (of_date,) = arcs(message)
    edited(message, "TIME_SYSTEM", "REF_FRAME_EPOCH = 1996-09-28T12:09:45\nTIME_SYSTEM")
    (of_epoch,) = arcs(message)
    angle = np.linalg.norm(of_epoch.positions - of_date.positions, axis=1) / np.linalg.norm(
        of_date.positions, axis=1
    )
    assert 1e-4 < angle.max() < np.radians(0.3)
    edited(message, "1996-09-28", "2016-09-28")
    np.testing.assert_allclose(arcs(message)[0].positions, of_date.positions, rtol=0, atol=5.0)


@pytest.mark.parametrize(("old", "new", "line"), refusals("oem_arcs"))
def test_arcs_that_are_cut_or_malformed_are_named(message, old, new, line):
    edited(message, old, new)
    with pytest.raises(InputError, match=f"iss.oem: .*expected {line}"):
        arcs(message)
