"""Conjunctions between files: OEM with covariances, mean elements, and what the command prints."""

from dataclasses import replace

import numpy as np
import pytest
from test_approaches import T, built, kepler

from opml import cli
from opml.base.errors import InputError
from opml.conjunctions import cdm, screening
from opml.conjunctions.screening import EPOCH
from opml.interop import oem
from opml.orbits.elements import rsw_rotation

COVARIANCE = np.diag(np.square([30.0, 200.0, 10.0, 0.2, 0.03, 0.01]))
RUN = "2023-05-01T00:00:00"


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
        segment = oem.Segment(name, T, states, sparse, covariances, covariance_frame=frame)
        paths.append(tmp_path / f"{name}.oem")
        oem.write(paths[-1], [segment], epoch=RUN)
    return paths, at, miss


def test_the_meeting_is_found_with_the_covariances_of_its_time(files):
    paths, at, miss = files
    found = screening.screen(screening.read(paths), within=5000.0, radius=20.0)
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
    assert cdm.read(messages[0], epoch=EPOCH).radius == 15.0
    assert cli.main(["screen", str(messages[0]), "--csv"]) == 0
    assert capsys.readouterr().out.startswith("tca,first,second,miss_m,r_m")
    assert cli.main(["screen", *arguments[:2], "--within", "0.000001"]) == 0
    assert capsys.readouterr().out == "no conjunction\n"


def test_mean_elements_have_no_covariance_and_it_is_said(files, tmp_path, capsys):
    """The set is SGP4 fitted to the second object, which ours meets."""
    paths, *_ = files
    assert cli.main(["elements", str(paths[1]), "--every", "24", "--span", "1", "--number", "77"]) == 0
    sets = tmp_path / "sets.tle"
    sets.write_text(capsys.readouterr().out)
    assert cli.main(["screen", str(paths[0]), str(sets), "--within", "900"]) == 0
    lines = capsys.readouterr().out.splitlines()[1:]
    assert lines
    assert all("77 without covariance" in line for line in lines)


@pytest.fixture
def short(tmp_path):
    """An OEM of twenty minutes, with a covariance every ten."""
    t = T[:21]
    states = kepler(built(np.random.default_rng(5))[0], 0.0, t)
    covariances = np.repeat(COVARIANCE[None], 3, axis=0)
    path = tmp_path / "short.oem"
    segment = oem.Segment("short", t, states, t[::10], covariances, covariance_frame="RSW")
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


FIRST = 14  # line of the first state, counted from 0
DAMAGES = {
    "a state before its time": (lambda lines: swapped(lines, FIRST + 3), "line 19: expected a later epoch"),
    "a time twice": (lambda lines: [*lines[:19], *lines[18:]], "line 20: expected a later epoch"),
    "a covariance twice": (
        lambda lines: [*lines[:-9], *lines[-17:]],
        "expected a later epoch than before",
    ),
    "a negative variance": (
        lambda lines: [line.replace("0.0009", "-0.0009") for line in lines],
        "expected a variance of 0 or more, got -0.0009",
    ),
    "metres": (lambda lines: in_metres(lines, range(1, 7)), "short: expected positions 6000 to 1e\\+06 km"),
    "metres per second": (lambda lines: in_metres(lines, range(4, 7)), "velocities that lead from position"),
    "three states": (lambda lines: [*lines[: FIRST + 3], *lines[FIRST + 21 :]], "at least 4 states, got 3"),
    "a gap": (lambda lines: [*lines[:20], *lines[30:]], "short: expected states at most 300 s apart"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_ephemerides_are_told_in_one_line(short, damage):
    harm, expected = DAMAGES[damage]
    screening.read([short])
    short.write_text("\n".join(harm(short.read_text().splitlines())) + "\n")
    with pytest.raises(InputError, match=expected) as raised:
        screening.read([short])
    assert str(raised.value).startswith(str(short))
    assert "\n" not in str(raised.value)


def test_ephemerides_that_share_no_time_are_told(short, files):
    (ours,), (other, *_) = screening.read([short]), screening.read(files[0])
    later = replace(other, path=replace(other.path, t=other.path.t + 1e9))
    with pytest.raises(InputError, match=r"another ephemeris from 2023-05-01T00:00:00\.0+ to .*, got none"):
        screening.screen([ours, later], within=1e3, radius=20.0)
    assert screening.screen([ours, later, other], within=1.0, radius=20.0) == []


def test_the_command_names_those_at_other_times(short, files, tmp_path, capsys):
    (segment,) = oem.read(short, epoch=EPOCH)
    oem.write(tmp_path / "late.oem", [replace(segment, name="late", t=segment.t + 1e7)], epoch=EPOCH)
    assert cli.main(["screen", str(short), str(files[0][0]), str(tmp_path / "late.oem")]) == 0
    assert capsys.readouterr().err == f"opml: at other times than {short}: late\n"


@pytest.mark.parametrize("lengths", [(0.0, 20.0), (float("nan"), 20.0), (1e3, -1.0), (1e3, float("inf"))])
def test_lengths_that_are_none_are_refused(short, files, lengths):
    with pytest.raises(InputError, match=r"^(within|radius): expected a length above 0, got"):
        screening.screen(screening.read([short, *files[0]]), within=lengths[0], radius=lengths[1])


def test_a_message_is_no_ephemeris(short, tmp_path):
    (tmp_path / "case.cdm").write_text("CCSDS_CDM_VERS = 1.0\n")
    with pytest.raises(InputError, match=r"case\.cdm: expected an ephemeris or mean elements, got a CDM"):
        screening.read([short, tmp_path / "case.cdm"])


def test_what_cannot_be_screened_is_told_in_one_line(files, tmp_path):
    paths, *_ = files
    with pytest.raises(InputError, match="expected ephemerides of another"):
        screening.screen(screening.read([paths[0], paths[0]]), within=1e3, radius=20.0)
    sets = tmp_path / "nothing.tle"
    sets.write_text("nothing\n")
    with pytest.raises(InputError, match=r"nothing\.tle"):
        screening.read([paths[0], sets])
    with pytest.raises(InputError, match="expected an OEM among the files"):
        screening.read([sets])
