"""Conjunctions between files: OEM with covariances, mean elements, and what the command prints."""

import io
import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from support import refusal
from test_approaches import T, built, kepler

from opml import cli
from opml.base.constants import EARTH_GM
from opml.base.errors import InputError
from opml.conjunctions import as_text, cdm, screening
from opml.interop import known_orbits, oem
from opml.interop.element_sets import element_set, omm, tle
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.orbits.elements import rsw_rotation

COVARIANCE = np.diag(np.square([30.0, 200.0, 10.0, 0.2, 0.03, 0.01]))
RUN = "2023-05-01T00:00:00"
SAT = ObjectId("SAT", number=77)


@pytest.fixture
def files(tmp_path):
    """OEM of two objects that meet, the first with covariances in RSW, the second with the same in GCRF."""
    first, second, at, miss = built(np.random.default_rng(5))
    paths = []
    for name, state, frame in (("ours", first, "RSW"), ("other", second, "GCRF")):
        states = kepler(state, at, T)
        sparse = T[::10]
        covariances = np.repeat(COVARIANCE[None] * np.linspace(1, 3, len(sparse))[:, None, None], 1, axis=0)
        if frame == "GCRF":
            turns = np.array([np.kron(np.eye(2), axes.T) for axes in rsw_rotation(states[::10])])
            covariances = turns @ covariances @ turns.transpose(0, 2, 1)
        segment = Ephemeris(name, T, states, sparse, covariances, covariance_frame=frame)
        paths.append(tmp_path / f"{name}.oem")
        oem.write(paths[-1], [segment], epoch=RUN)
    return paths, at, miss


def screened(paths, *, within=5000.0):
    """What is found where objects of 20 m pass each other."""
    return screening.screen(screening.read(paths), within=within, radius=20.0)


def test_the_meeting_is_found_with_the_covariances_of_its_time(files):
    paths, at, miss = files
    found = screened(paths)
    (one,) = (one for one in found if abs(np.linalg.norm(one.relative[:3]) - miss) < 1.0)
    scale = 1.0 + 2.0 * at / T[-1]
    for participant in (one.first, one.second):
        np.testing.assert_allclose(participant.covariance, scale * COVARIANCE, rtol=1e-3, atol=1e-3)
    assert one.is_short
    assert 0.0 <= one.chance.probability <= one.chance.most


def test_the_command_prints_a_line_of_each_and_writes_messages(files, tmp_path, capsys):
    paths, _, miss = files
    folder = tmp_path / "messages"
    arguments = [*map(str, paths), "--within", "5", "--radius", "15", "--messages", str(folder)]
    assert cli.main(["screen", *arguments]) == 0
    heading, *lines = capsys.readouterr().out.splitlines()
    assert heading.split()[:4] == ["tca", "first", "second", "miss_m"]
    assert f"{miss:.0f}" in [line.split()[3] for line in lines]
    messages = sorted(folder.iterdir())
    assert len(messages) == len(lines)
    assert cdm.read(messages[0], epoch=EPOCH)[0].radius == 15.0
    assert cli.main(["screen", str(messages[0]), "--csv"]) == 0
    table = pd.read_csv(io.StringIO(capsys.readouterr().out))
    assert list(table)[:5] == ["tca", "first", "second", "miss_m", "r_m"]
    assert cli.main(["screen", str(messages[0]), "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert row["miss_m"] == pytest.approx(table["miss_m"][0])
    with pytest.raises(SystemExit):
        cli.main(["screen", *arguments, "--csv", "--json"])
    assert "argument --json: not allowed with argument --csv" in capsys.readouterr().err
    assert cli.main(["screen", *arguments[:2], "--within", "0.000001"]) == 0
    assert capsys.readouterr().out.startswith("no approach within")
    assert cli.main(["screen", *map(str, paths), "--within", "0.001", "--csv"]) == 0
    assert capsys.readouterr().out == ",".join(as_text.table([], epoch=EPOCH).columns) + "\n"


def test_a_message_of_a_long_name_has_a_file_and_a_bad_one_of_four_is_skipped(files, tmp_path, caplog):
    paths, *_ = files
    (segment,) = known_orbits.segments(paths[1], epoch=EPOCH)
    others, folder = tmp_path / "others", tmp_path / "messages"
    others.mkdir()
    for k in range(3):
        oem.write(others / f"{k}.oem", [replace(segment, name=f"{k}" * 300)], epoch=EPOCH)
    (others / "page.oem").write_text("<html>")
    assert cli.main(["screen", str(paths[0]), str(others), "--messages", str(folder)]) == 0
    assert list(folder.iterdir())
    assert "skipped, a file of 1 in 4" in caplog.text


def flown_set(path, *, eccentricity=0.001):
    """A set of an orbit at 630 km; returns its file."""
    motion = 0.0646  # rad/min
    tle.write(path, element_set.satellite(RUN, [motion, eccentricity, 1.2, 0.3, 0.4, 0.5, 1e-4]), SAT)
    return path


@pytest.mark.parametrize("eccentricity", [0.001, 0.05], ids=["round", "eccentric"])
def test_mean_elements_have_the_covariance_that_is_usual_for_round_orbits(eccentricity, files, tmp_path):
    sets = flown_set(tmp_path / "sets.tle", eccentricity=eccentricity)
    found = screened([files[0][0], sets], within=1.5e7)
    assert found
    remark = ("covariance of 77 is typical of public sets at its height",)
    for one in found:
        assert (one.second.covariance is not None) == (one.second.remarks == remark) == (eccentricity < 0.02)


def test_sets_share_what_the_density_is_off_by(files, tmp_path):
    """Two sets of one height and epoch, days ahead: a common error carries both."""
    tilt, apart, motion = 1.2, 2.0, 0.0646
    crossing = 0.5 * (apart + np.pi)  # longitude from the first node, of where circles of one tilt cross
    first = np.arctan2(np.sin(crossing) / np.cos(tilt), np.cos(crossing))
    for number, node, place in ((77, 0.0, 0.0), (78, apart, np.pi - 2.0 * first)):
        satellite = element_set.satellite(RUN, [motion, 1e-5, tilt, node, 0.0, place % (2.0 * np.pi), 5e-4])
        tle.write(tmp_path / f"{number}.tle", satellite, ObjectId("SAT", number=number))
    span = written(tmp_path / "span.oem", "span", OURS, edges=(4.0 * 86400.0, 4.1 * 86400.0), step=60.0)
    read = screening.read([tmp_path / "77.tle", tmp_path / "78.tle", span])
    found = screening.screen(read, within=1e5, radius=20.0)
    table = as_text.table(found, epoch=EPOCH)
    own = table["second"].str.contains("78")
    assert (table.loc[own, "correlated"] > 0.0).any()
    assert not np.allclose(table.loc[own, "correlated"], table.loc[own, "probability"], rtol=0.05)
    assert table.loc[~own, "correlated"].isna().all()
    for one in found:
        for member in (one.first, one.second):
            if member.density is not None:
                effect = member.density.effect
                held = member.covariance - np.outer(effect, effect)
                sigma = np.sqrt(np.diag(member.covariance))
                assert np.linalg.eigvalsh(held / np.outer(sigma, sigma)).min() > -1e-9


def test_the_usual_covariance_ends_with_what_was_learned(tmp_path):
    ours = written(tmp_path / "ours.oem", "ours", OURS, edges=(0.0, 12 * 86400.0), step=300.0)
    _, other = screening.read([ours, flown_set(tmp_path / "sets.tle")])
    (trajectory,) = other.trajectories
    ahead = trajectory.covariances_at(trajectory.t[0] + 86400.0 * np.array([0.0, 1.0, 7.0, 9.9, 10.1]))
    known = np.sqrt(ahead[:3, 1, 1])
    assert np.isfinite(ahead).all(axis=(1, 2)).tolist() == [True, True, True, True, False]
    assert 500.0 <= known[0] < known[1] < known[2]


def written(path, name, state, *, identifier="", at=9000.0, edges=(0.0, 18000.0), step=60.0):
    """An OEM of an ellipse, a segment between each two edges [s]."""
    spans = [np.arange(begin, end + 1.0, step) for begin, end in pairwise(edges)]
    identity = ObjectId.of(name, identifier)
    segments = [Ephemeris(name, t, kepler(state, at, t), identity=identity) for t in spans]
    oem.write(path, segments, epoch=RUN)
    return path


SPEED = np.sqrt(EARTH_GM / 7e6)
OURS = np.array([7e6, 0.0, 0.0, 0.0, SPEED, 0.0])
CROSSING = np.array([7e6 + 20.0, 0.0, 0.0, 0.0, 0.28 * SPEED, 0.96 * SPEED])
"""A state 20 m above ours, on another plane."""

SLOWER = np.array([7e6 - 300.0, -500.0, 0.0, 0.0, SPEED * (1.0 + 1.5 * 300.0 / 7e6), 0.0])
"""A state on a lower orbit, which catches up with ours, at its end half a kilometre away."""

ECCENTRIC = np.array([7e6 + 7.0, 0.0, 0.0, 0.0, 0.5 * SPEED * np.sqrt(1.74), 0.87 * SPEED * np.sqrt(1.74)])
"""A perigee 7 m above ours, of e 0.74."""

FAR_BETWEEN = {"at": 9150.0, "step": 300.0}
MEETINGS = {
    "ours in segments": ((OURS, {"edges": (0.0, 6000.0, 18000.0)}), (CROSSING, {}), 20.0),
    "the other in segments": ((OURS, {}), (CROSSING, {"edges": (0.0, 12000.0, 18000.0)}), 20.0),
    "at the seam of segments": ((OURS, {"edges": (0.0, 9000.0, 18000.0)}), (CROSSING, {}), 20.0),
    "a copy": ((OURS, {}), (OURS, {}), 0.0),
    "closing in as the file ends": ((OURS, {"edges": (0.0, 9000.0)}), (SLOWER, {}), 583.0),
    "a perigee between states": ((OURS, FAR_BETWEEN), (ECCENTRIC, {"at": 9150.0}), 7.0),
    "both far between": ((OURS, FAR_BETWEEN), (ECCENTRIC, FAR_BETWEEN), 7.0),
    "debris": ((OURS, {"identifier": "1999-025AAA"}), (CROSSING, {"identifier": "99025BBB"}), 20.0),
}


@pytest.mark.parametrize("meeting", MEETINGS)
def test_a_meeting_is_not_missed(meeting, tmp_path):
    (ours, ours_known), (other, other_known), miss = MEETINGS[meeting]
    paths = [
        written(tmp_path / "ours.oem", "DEB", ours, **{"identifier": "2000-001A"} | ours_known),
        written(tmp_path / "other.oem", "DEB", other, **{"identifier": "2000-001B"} | other_known),
    ]
    found = screened(paths, within=1e3)
    nearest = min(np.linalg.norm(one.relative[:3]) for one in found)
    assert nearest == pytest.approx(miss, abs=12.0)


def test_where_nothing_is_known_beyond_it_is_said(tmp_path):
    ours = written(tmp_path / "ours.oem", "ours", OURS, edges=(0.0, 9000.0))
    found = screened([ours, written(tmp_path / "b.oem", "b", SLOWER)], within=1e3)
    *_, row = as_text.table(found, epoch=EPOCH).to_dict("records")
    assert row["remark"] == "nothing known beyond; no covariance"
    assert row["tca"] == "2023-05-01T02:30:00.000000"


def elements(path, *, epoch=RUN, identifier="2001-001A", bstar=0.0, number=77):
    """An OMM of an object at 600 km."""
    motion = 60.0 * np.sqrt(EARTH_GM / 7e6**3)
    satellite = element_set.satellite(epoch, [motion, 1e-3, 1.0, 1.0, 1.0, 1.0, bstar])
    omm.write(path, satellite, identity=ObjectId("SAT", number=number), epoch=epoch, comment="")
    path.write_text(path.read_text().replace("OBJECT_ID = SAT", f"OBJECT_ID = {identifier}"))
    return path


def test_two_numbers_with_one_designator_are_told(tmp_path):
    paths = [elements(tmp_path / f"{number}.omm", number=number) for number in (77, 78)]
    found = screening.screen(screening.read(paths, days=1.0), within=1e3, radius=20.0)
    told = "both have the designator 2001-001A: are they one object?"
    assert as_text.table(found, epoch=EPOCH)["remark"].str.contains(told, regex=False).all()
    assert found


def test_our_own_elements_are_not_held_against_us_and_it_is_said(tmp_path, caplog):
    ours = written(tmp_path / "ours.oem", "ISS", OURS, identifier="2001-001-A")
    other = written(tmp_path / "other.oem", "b", CROSSING)
    found = screened([ours, other, elements(tmp_path / "own.omm")], within=1.5e7)
    assert {one.second.identity.name for one in found} == {"b"}
    assert caplog.messages == ["own.omm: SAT (77, 2001-001A) is ours itself"]


def test_elements_in_the_first_place_are_ours(files, tmp_path):
    found = screened([elements(tmp_path / "own.omm"), *files[0]], within=1.5e7)
    assert {one.first.identity.name for one in found} == {"SAT"}
    assert {one.second.identity.name for one in found} == {"ours", "other"}


AGES = {
    "2023-04-29T00:00:00": ["covariance of SAT is typical of public sets at its height"],
    "2023-04-20T00:00:00": ["elements of SAT 11 d old"],
    "2023-05-12T00:00:00": ["elements of SAT 11 d ahead"],
}


@pytest.mark.parametrize("epoch", AGES)
def test_the_age_of_elements_is_told(epoch, tmp_path):
    ours = written(tmp_path / "ours.oem", "ours", OURS)
    sets = elements(tmp_path / "sets.omm", epoch=epoch)
    found = screened([ours, sets], within=1.5e7)
    assert [list(one.second.remarks) for one in found] == [AGES[epoch]] * len(found)
    assert found


def test_elements_that_are_too_old_do_not_fly(files, tmp_path, caplog):
    sets = elements(tmp_path / "sets.omm", epoch="2005-01-01T00:00:00")
    screened([*files[0], sets], within=1.0)
    told = "unknown from 2023-05-01T00:00:00 to 2023-05-03T00:00:00: its elements are of 2005-01-01T00:00:00"
    assert caplog.messages == [f"SAT (77, 2001-001A): {told}"]
    with pytest.raises(InputError, match=r"expected elements that SGP4 propagates from 2023-05-01"):
        screening.read([sets, *files[0]])


def test_covariances_do_not_reach_beyond_their_times(tmp_path):
    t = np.arange(0.0, 18001.0, 60.0)
    segment = Ephemeris("ours", t, kepler(OURS, 9000.0, t), t[:1], COVARIANCE[None], covariance_frame="RSW")
    oem.write(tmp_path / "ours.oem", [segment], epoch=RUN)
    paths = [tmp_path / "ours.oem", written(tmp_path / "other.oem", "b", CROSSING)]
    rows = as_text.table(screened(paths, within=1e3), epoch=EPOCH)
    expected = ["b without covariance"] + ["covariances of ours are of other times; no covariance"] * 6
    assert rows["remark"].tolist() == expected
    assert rows["probability"].isna().tolist() == [False] + [True] * 6


@pytest.mark.parametrize(
    ("times", "known"),
    [
        (1e6, "other known to [0-9]{3} km"),
        (0.0, "covariance of other zero, as where it is unknown"),
        (1e-8, "other known to [1-9][0-9]* mm"),
    ],
    ids=["metres for kilometres", "none", "centimetres"],
)
def test_a_covariance_that_no_orbit_has_is_told(times, known, files, tmp_path):
    paths, *_ = files
    (one,) = known_orbits.segments(paths[1], epoch=RUN)
    odd = replace(one, covariances=times * one.covariances)
    oem.write(tmp_path / "odd.oem", [odd], epoch=RUN)
    found = screened([paths[0], tmp_path / "odd.oem"])
    told = as_text.table(found, epoch=EPOCH)["remark"]
    assert told.str.contains(known).all()
    usual = as_text.table(screened(paths), epoch=EPOCH)
    assert not usual["remark"].str.contains("known to").any()


def test_a_message_takes_no_distance(files, tmp_path, capsys):
    paths, *_ = files
    assert cli.main(["screen", *map(str, paths), "--messages", str(tmp_path / "messages")]) == 0
    (message, *_) = (tmp_path / "messages").iterdir()
    assert cli.main(["screen", str(message), "--within", "1"]) == 1
    assert "--within: expected ephemerides to screen, got a conjunction" in capsys.readouterr().err


def test_our_file_is_of_one_object(files, tmp_path):
    (one,), (other,) = (known_orbits.segments(path, epoch=EPOCH) for path in files[0])
    oem.write(tmp_path / "both.oem", [one, other], epoch=EPOCH)
    with pytest.raises(InputError, match=r"both\.oem: expected one object, ours, got ours, other"):
        screening.read([tmp_path / "both.oem", files[0][0]])


@pytest.fixture
def short(tmp_path):
    """An OEM of twenty minutes, with a covariance every ten."""
    t = T[:21]
    states = kepler(built(np.random.default_rng(5))[0], 0.0, t)
    covariances = np.repeat(COVARIANCE[None], 3, axis=0)
    path = tmp_path / "short.oem"
    segment = Ephemeris("short", t, states, t[::10], covariances, covariance_frame="RSW")
    oem.write(path, [segment], epoch=RUN)
    return path


def swapped(lines, at):
    return [*lines[:at], lines[at + 1], lines[at], *lines[at + 2 :]]


def in_metres(lines, columns):
    """Lines in which some columns of the states are a thousand times larger."""
    return [
        " ".join(
            f"{value}e3" if line.startswith("20") and column in columns else value
            for column, value in enumerate(line.split())
        )
        for line in lines
    ]


def moved(line, x):
    """The line of a state that is moved along the first axis [km]."""
    time, value, *rest = line.split()
    return " ".join([time, str(float(value) + x), *rest])


FIRST = 14  # line of the first state, counted from 0
DAMAGES = {
    "a state before its time": (lambda lines: swapped(lines, FIRST + 3), "line 19: expected a later epoch"),
    "a time twice": (lambda lines: [*lines[:19], *lines[18:]], "line 20: expected a later epoch"),
    "a covariance twice": (lambda lines: [*lines[:-9], *lines[-17:]], "expected a later epoch than before"),
    "a negative variance": (
        lambda lines: [line.replace("0.0009", "-0.0009") for line in lines],
        "expected a variance of 0 or more, got -0.0009",
    ),
    "metres": (lambda lines: in_metres(lines, range(1, 7)), "short: expected positions 6000 to 1e\\+06 km"),
    "metres per second": (lambda lines: in_metres(lines, range(4, 7)), "velocities that lead from position"),
    "a state 5 km off": (
        lambda lines: [*lines[:20], moved(lines[20], 5.0), *lines[21:]],
        "short: expected velocities that lead .* got 5 km off at 2023-05-01T00:06:00",
    ),
    "three states": (lambda lines: [*lines[: FIRST + 3], *lines[FIRST + 21 :]], "at least 4 states, got 3"),
    "cut": (lambda lines: lines[: FIRST + 12], "line 26: expected states up to STOP_TIME = 2023-05-01T00:20"),
    "a gap": (lambda lines: [*lines[:20], *lines[30:]], "short: expected states at steps of at most 300 s"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_ephemerides_are_told_in_one_line(short, damage):
    harm, expected = DAMAGES[damage]
    screening.read([short])
    lines = short.read_text().splitlines()
    if damage != "cut":
        lines = ["STOP_TIME = 2023-05-01T00:02:00" if line.startswith("STOP") else line for line in lines]
    short.write_text("\n".join(harm(lines)) + "\n")
    with pytest.raises(InputError, match=expected) as raised:
        screening.read([short])
    assert str(raised.value).startswith(str(short))
    assert "\n" not in str(raised.value)


def test_ephemerides_that_share_no_time_are_told(short, files, tmp_path, caplog):
    (segment,) = known_orbits.segments(short, epoch=EPOCH)
    late = tmp_path / "late.oem"
    moved = {"t": segment.t + 1e7, "covariance_t": segment.covariance_t + 1e7}
    oem.write(late, [replace(segment, name="late", identity=UNKNOWN, **moved)], epoch=EPOCH)
    with pytest.raises(InputError, match=r"another ephemeris from 2023-05-01T00:00:00 to .*, got none"):
        screened([short, late], within=1e3)
    caplog.clear()
    assert screened([short, late, files[0][1]], within=1.0) == []
    assert caplog.messages == ["late: unknown from 2023-05-01T00:00:00 to 2023-05-01T00:20:00"]


@pytest.mark.parametrize(
    "lengths", [(0.0, 20.0), (float("nan"), 20.0), (1e3, -1.0), (1e3, float("inf")), (1e3, 2e4)]
)
def test_lengths_that_no_pair_has_are_refused(short, files, lengths):
    expected = "at most 10000 m, got 20000 m" if 2e4 in lengths else "a length above 0, got"
    with pytest.raises(InputError, match=rf"^(within|radius): expected {expected}"):
        screening.screen(screening.read([short, *files[0]]), within=lengths[0], radius=lengths[1])


def test_segments_that_hold_the_same_states_tell_an_approach_once(files):
    paths, *_ = files
    once = screened(paths)
    (segment,) = known_orbits.segments(paths[1], epoch=RUN)
    part, covered = T[len(T) // 2 + 90] > T, segment.covariance_t < T[len(T) // 2 + 90]
    begin = replace(
        segment,
        t=T[part],
        states=segment.states[part],
        covariance_t=segment.covariance_t[covered],
        covariances=segment.covariances[covered],
    )
    oem.write(paths[1], [begin, segment], epoch=RUN)
    assert len(screening.read(paths)[1].trajectories) == 2
    again = screened(paths)
    assert [one.t for one in again] == pytest.approx([one.t for one in once], abs=1e-6)


def test_a_message_is_no_ephemeris(short, tmp_path):
    (tmp_path / "case.cdm").write_text("CCSDS_CDM_VERS = 1.0\n")
    with pytest.raises(InputError, match=r"case\.cdm: expected an orbit .* or element sets .*, got CDM"):
        screening.read([short, tmp_path / "case.cdm"])


def test_what_cannot_be_screened_is_told_in_one_line(files, tmp_path):
    paths, *_ = files
    with pytest.raises(InputError, match=r"^conjunctions: expected ephemerides of another object than"):
        screened([paths[0], paths[0]], within=1e3)
    sets = tmp_path / "nothing.tle"
    sets.write_text("nothing\n")
    assert "nothing.tle" in refusal(screening.read, [paths[0], sets])
