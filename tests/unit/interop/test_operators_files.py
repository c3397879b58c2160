"""Ephemerides of operators, in modified ITC and STK's format: the orbit and covariances of the same OEM."""

import numpy as np
import pytest
from support import EPOCH, refusal

from opml.interop import known_orbits, oem
from opml.interop.ephemeris import Ephemeris
from opml.orbits.elements import rsw_rotation

T = np.arange(0.0, 601.0, 60.0)
NAME = "MEME_44714_STARLINK-1008_2711218_Operational_1379800620_UNCLASSIFIED.txt"
STATES = np.stack([
    6.9e6 * np.cos(1.1e-3 * T), 6.9e6 * np.sin(1.1e-3 * T), 1e3 + 0.0 * T,
    -7590.0 * np.sin(1.1e-3 * T), 7590.0 * np.cos(1.1e-3 * T), 0.0 * T,
], axis=1)  # fmt: skip
SPREAD = np.diag([100.0, 900.0, 25.0, 0.04, 0.01, 0.01]) + 0.0
SPREAD[1, 0] = SPREAD[0, 1] = -150.0
TRIANGLE = SPREAD[np.tril_indices(6)]


def starlink(folder, edit=lambda text: text):
    lines = ["created:2016-09-28 05:05:11 UTC", "ephemeris_start:x", "ephemeris_source:blend", "UVW"]
    for t, state in zip(T, STATES, strict=True):
        clock = f"201627212{9 + int(45 + t) // 60:02d}{(45 + t) % 60:06.3f}"
        lines.append(" ".join([clock, *(f"{value / 1e3:.10f}" for value in state)]))
        lines += [" ".join(f"{value / 1e6:.10e}" for value in part) for part in np.split(TRIANGLE, 3)]
    path = folder / NAME
    path.write_text(edit("\n".join(lines) + "\n"))
    return path


def stk(folder, edit=lambda text: text):
    axes = np.kron(np.eye(2), rsw_rotation(STATES))
    covariances = axes.transpose(0, 2, 1) @ SPREAD @ axes
    rows = [" ".join(map(repr, [t, *state])) for t, state in zip(T.tolist(), STATES.tolist(), strict=True)]
    known = [
        " ".join(map(repr, [t, *one[np.tril_indices(6)].tolist()]))
        for t, one in zip(T.tolist(), covariances, strict=True)
    ]
    lines = [
        *("stk.v.11.0", "# WrittenBy STK", "BEGIN Ephemeris", f"NumberOfEphemerisPoints {len(T)}"),
        *("ScenarioEpoch 28 Sep 2016 12:09:45.000", "InterpolationMethod Hermite", "CentralBody Earth"),
        *("CoordinateSystem ICRF", "EphemerisTimePosVel", "", *rows, "", "CovarianceTimePosVel", *known),
        "END Ephemeris",
    ]
    path = folder / "mine.e"
    path.write_text(edit("\n".join(lines) + "\n"))
    return path


def test_an_operator_s_orbit_has_its_covariances_and_its_name(tmp_path):
    orbit = known_orbits.read([starlink(tmp_path)], "44714")
    assert str(orbit.identity) == "STARLINK-1008 (44714)"
    oem.write(tmp_path / "same.oem", [Ephemeris("X", T, STATES)], epoch=EPOCH)
    text = (tmp_path / "same.oem").read_text()
    (tmp_path / "same.oem").write_text(text.replace("REF_FRAME = GCRF", "REF_FRAME = EME2000"))
    same = known_orbits.read([tmp_path / "same.oem"])
    np.testing.assert_allclose(orbit.t, same.t, atol=1e-6)
    np.testing.assert_allclose(orbit.at(orbit.t), same.at(same.t), atol=1e-4)
    np.testing.assert_allclose(orbit.covariances(orbit.t)[3], SPREAD, rtol=1e-9, atol=1e-9)


def test_an_ephemeris_of_stk_has_states_and_covariances(tmp_path):
    (segment,) = known_orbits.segments(stk(tmp_path), epoch=EPOCH)
    assert segment.name == "mine"
    np.testing.assert_allclose(segment.t, T, atol=1e-6)
    np.testing.assert_array_equal(segment.states, STATES)
    orbit = known_orbits.read([tmp_path / "mine.e"])
    np.testing.assert_allclose(orbit.covariances(orbit.t)[-1], SPREAD, rtol=1e-6, atol=1e-6)


def test_units_and_frames_of_stk_are_turned(tmp_path):
    (fixed,) = known_orbits.segments(
        stk(tmp_path, lambda text: text.replace("System ICRF", "System Fixed")), epoch=EPOCH
    )
    assert len(fixed.covariances) == 0
    assert np.linalg.norm(fixed.states[:, 3:], axis=1).min() > 7900.0  # the Earth's turn comes on top
    path = stk(tmp_path, lambda text: text.replace("ICRF", "J2000\nDistanceUnit Kilometers"))
    (wide,) = known_orbits.segments(path, epoch=EPOCH)
    np.testing.assert_allclose(np.linalg.norm(wide.states[:, :3], axis=1), 6.9e9, rtol=1e-6)


@pytest.mark.parametrize(
    ("write", "old", "new", "said"),
    [
        (starlink, "UVW", "XYZ", "line 4: expected UVW, the axes of covariances, got XYZ"),
        (starlink, " 9.0", " x", "a finite number, got x"),
        (starlink, "20162721210", "20163991210", "line 9: expected a time YYYYDDDhhmmss.sss, got 2016399"),
        (starlink, "20162721211", "20162721209", "line 13: expected a later epoch than before"),
        (stk, "CentralBody Earth", "CentralBody Mars", "line 7: expected centralbody earth, got Mars"),
        (stk, "ICRF", "TrueOfDate", "expected coordinatesystem j2000 or icrf or fixed, got TrueOf"),
        (stk, "28 Sep 2016 12", "28 Sept 12", "line 5: expected ScenarioEpoch 1 Jan 2020"),
        (stk, "END Ephemeris", "", "expected END Ephemeris, got the end of the file"),
        (stk, "\n60.0 ", "\n60.0 1.0 ", "expected 7 numbers of ephemeristimeposvel, got 60.0"),
    ],
    ids=["axes", "number", "day", "order", "body", "frame", "epoch", "end", "width"],
)
def test_what_is_malformed_is_told_by_line(write, old, new, said, tmp_path):
    path = write(tmp_path, lambda text: text.replace(old, new))
    assert said in refusal(known_orbits.segments, path, epoch=EPOCH)


def test_a_cut_ephemeris_is_noticed(tmp_path):
    path = starlink(tmp_path, lambda text: "\n".join(text.splitlines()[:-1]))
    assert "expected 3 lines of covariance behind each state" in refusal(
        known_orbits.segments, path, epoch=EPOCH
    )
