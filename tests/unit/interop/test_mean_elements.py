"""TLE and OMM: one set of elements in four spellings, states against Vallado's, and files that are wrong."""

import json
import subprocess
import sys

import numpy as np
import pytest
from support import REPOSITORY, refusal, refusals

from opml import cli
from opml.base.errors import InputError
from opml.catalog.simulate.truth import initial_state
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import elements_epoch
from opml.orbits.sheets import read_rsos

# The first satellite of the verification set of Vallado et al. 2006 (AIAA 2006-6753), and as an OMM.
LINES = (
    "1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753",
    "2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667",
)
OMM = {
    "OBJECT_NAME": "VANGUARD 1",
    "OBJECT_ID": "1958-002B",
    "CENTER_NAME": "EARTH",
    "REF_FRAME": "TEME",
    "TIME_SYSTEM": "UTC",
    "MEAN_ELEMENT_THEORY": "SGP4",
    "EPOCH": "2000-06-27T18:50:19.733568",
    "MEAN_MOTION": "10.82419157",
    "ECCENTRICITY": "0.1859667",
    "INCLINATION": "34.2682",
    "RA_OF_ASC_NODE": "348.7242",
    "ARG_OF_PERICENTER": "331.7664",
    "MEAN_ANOMALY": "19.3264",
    "EPHEMERIS_TYPE": "0",
    "CLASSIFICATION_TYPE": "U",
    "NORAD_CAT_ID": "5",
    "ELEMENT_SET_NO": "475",
    "REV_AT_EPOCH": "41366",
    "BSTAR": "0.000028098",
    "MEAN_MOTION_DOT": "0.00000023",
    "MEAN_MOTION_DDOT": "0",
}
THREE_DAYS_ON = "2000-06-30T18:50:19.733571"
TEN_DAYS_ON = "2000-07-07T18:50:19.733568"
A_MONTH_ON = "2000-07-28T18:50:19.733568"


COMMAND = ["--name", "mine", "--area-to-mass", "0.05", "--cd", "2.2", "--cr", "1.25"]


def tle():
    return "\n".join(LINES) + "\n"


SPELLINGS = {
    "tle": tle(),
    "kvn": "CCSDS_OMM_VERS = 2.0\n" + "\n".join(f"{key} = {value}" for key, value in OMM.items()),
    "json": json.dumps([OMM]),
    "numbers": json.dumps(OMM | {"ECCENTRICITY": 0.1859667, "NORAD_CAT_ID": 5}),
    "marked": "\ufeff" + json.dumps([OMM]),
}


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "elements"
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize("text", SPELLINGS.values(), ids=SPELLINGS)
def test_every_spelling_gives_vallados_states(written, text):
    satellite = mean_elements.read(written(text))
    assert elements_epoch(satellite) == "2000-06-27T18:50:19.733568"
    error, position, velocity = satellite.sgp4_tsince(4320.0)
    assert error == 0
    # His table of results in TEME, printed to 1e-8 km; a spelling's epoch may be 4 microseconds off.
    expected = [-9060.47373569, 4658.70952502, 813.68673153, -2.232832783, -4.110453490, -3.157345433]
    np.testing.assert_allclose([*position, *velocity], expected, rtol=0, atol=1e-6)


def test_teme_turns_to_gcrf(written):
    # Appendix C of the same paper, in mean equator and equinox of J2000 by the IAU's 1976/1980 models without
    # corrections: 0.04" from GCRF at that date, thus 2 m.
    expected = [-9059.9413786e3, 4659.6972000e3, 813.9588875e3, -2233.348094, -4110.136162, -3157.394074]
    found = mean_elements.state(mean_elements.read(written(tle())), epoch=THREE_DAYS_ON)
    np.testing.assert_allclose(found[:3], expected[:3], rtol=0, atol=2.5)
    np.testing.assert_allclose(found[3:], expected[3:], rtol=0, atol=1e-3)


def test_the_command_adds_a_line_to_the_sheet(written, capsys, tmp_path):
    path = str(written(tle()))
    assert cli.main(["rso", path, *COMMAND, "--epoch", THREE_DAYS_ON]) == 0
    sheet = (REPOSITORY / "config" / "rsos.tsv").read_text()
    (tmp_path / "rsos.tsv").write_text(sheet + capsys.readouterr().out)
    found = read_rsos(tmp_path / "rsos.tsv")["mine"]
    expected = mean_elements.state(mean_elements.read(path), epoch=THREE_DAYS_ON)
    np.testing.assert_allclose(initial_state(found, mean_elements.EARTH_GM), expected, rtol=1e-12)


def test_the_command_says_what_is_wrong_in_one_line(written, capsys):
    assert cli.main(["rso", str(written("nothing")), *COMMAND, "--epoch", THREE_DAYS_ON]) == 1
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(("option", "value", "expected"), refusals("lines_of_the_sheet"))
def test_the_command_prints_no_line_that_the_sheet_would_refuse(written, capsys, option, value, expected):
    given = ["--epoch", THREE_DAYS_ON, *COMMAND]
    given[given.index(option) + 1] = value
    assert cli.main(["rso", str(written(tle())), *given]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith(f"opml: {expected}")
    assert told.err.count("\n") == 1


def test_the_command_warns_of_old_elements_in_one_line_on_stderr(written):
    command = [sys.executable, "-m", "opml", "rso", str(written(tle())), *COMMAND]
    done = subprocess.run([*command, "--epoch", TEN_DAYS_ON], capture_output=True, text=True, check=True)
    assert done.stderr == (
        "opml: mean elements: SGP4 carries them 10.0 days, from their epoch 2000-06-27T18:50:19.733568 to "
        "2000-07-07T18:50:19.733568; it errs by kilometres per day\n"
    )
    assert done.stdout.startswith("mine\t")


@pytest.mark.parametrize("epoch", [A_MONTH_ON, "2000-05-20T00:00:00"])
def test_elements_of_another_month_are_refused(written, capsys, epoch):
    assert cli.main(["rso", str(written(tle())), *COMMAND, "--epoch", epoch]) == 1
    error = capsys.readouterr().err
    assert error.startswith(
        "opml: mean elements: expected an epoch at most 30 days from theirs, "
        f"2000-06-27T18:50:19.733568, got {epoch}, 3"
    )
    assert error.count("\n") == 1


@pytest.mark.parametrize("name", ["1 KUNS-PF", "2 SAT", "N" * 45, "<script>", "[SAT]"])
def test_a_name_may_look_like_anything(written, name):
    path = written("\n".join([name, *LINES, name, *LINES]))
    assert [one.name for one in mean_elements.read_sets(path)] == [name, name]


def test_a_damaged_line_names_no_set(written):
    """Line 2 of the first set is cut: the set is left out, and the second has no name."""
    damaged = []
    (found,) = mean_elements.read_sets(written("\n".join([LINES[0], LINES[1][:30], *LINES])), damaged)
    assert not found.name
    assert len(damaged) == 1


@pytest.mark.parametrize(
    ("order", "sets", "damaged"),
    [("212121", 0, 6), ("21212", 2, 1), ("121", 1, 1), ("2121212", 3, 1), ("1221", 1, 2)],
)
def test_lines_2_before_lines_1_make_no_sets(written, order, sets, damaged):
    """Between a line 2 and a line 1 alone each line may belong to the one before it or to the one after."""
    text = "".join(LINES[int(kind) - 1] + "\n" for kind in order)
    errors = []
    assert len(mean_elements.read_sets(written(text), errors)) == sets
    assert len(errors) == damaged


def test_an_orbit_that_decayed_is_an_input_error(written):
    satellite = mean_elements.read(
        written(json.dumps(OMM | {"MEAN_MOTION": "16.4", "ECCENTRICITY": "0.001", "BSTAR": "0.01"}))
    )
    with pytest.raises(InputError, match=r"mean elements: expected an orbit at 2020-01-01T00:00:00, got"):
        mean_elements.state(satellite, epoch="2020-01-01T00:00:00")


def test_a_list_as_csv_is_read_and_several_are_told(tmp_path):
    (tmp_path / "one.csv").write_text(f"{','.join(OMM)}\n{','.join(OMM.values())}\n")
    (tmp_path / "json.omm").write_text(json.dumps(OMM))
    states = [
        mean_elements.state(mean_elements.read(tmp_path / name), epoch=THREE_DAYS_ON)
        for name in ("one.csv", "json.omm")
    ]
    np.testing.assert_array_equal(*states)
    path = tmp_path / "list.csv"
    for rows, said in ((2, "the mean elements of one RSO, got 2 sets"), (0, "element sets, got none")):
        path.write_text("\n".join([",".join(OMM), *[",".join(OMM.values())] * rows]))
        assert refusal(mean_elements.read, path) == f"{path}: expected {said}"
