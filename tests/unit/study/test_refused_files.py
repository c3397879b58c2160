"""Files, cells of the sheets and settings made wrong, one at a time: each is told in one line."""

import contextlib
import re
import shutil

import pytest
from data_files import sound_files
from support import REPOSITORY, paper_source

from opml.base.errors import InputError
from opml.study import checks
from opml.study.settings.merging import merged
from opml.study.settings.overlay import COMMAND_LINE, Layer


def cut(part):
    return lambda content: content[: int(part * len(content))]


def replaced(old, new, count=1):
    """Another text in place of a pattern's first matches."""

    def change(content):
        text = content.decode("latin-1")
        assert re.search(old, text, re.MULTILINE), old
        return re.sub(old, new, text, count=count, flags=re.MULTILINE).encode("latin-1")

    return change


ANY_TEXT = {
    "empty": lambda content: b"",
    "zeros": lambda content: bytes(1000),
    "text": lambda content: b"Not found\n",
    "html": lambda content: b"<!DOCTYPE html><title>404</title>",
    "picture": lambda content: b"\x89PNG\r\n\x1a\n" + bytes(range(256)),
}
GRAVITY = ANY_TEXT | {
    "cut in the head": cut(0.01),
    "cut in the rows": cut(0.5),
    "cut in the last row": lambda content: content[:-40],
    "no radius": replaced(r"^radius.*\n", ""),
    "radius of 0": replaced(r"^radius.*", "radius 0.0"),
    "radius of nan": replaced(r"^radius.*", "radius nan"),
    "negative constant": replaced(r"^earth_gravity_constant.*", "earth_gravity_constant -1"),
    "no degree": replaced(r"^max_degree.*\n", ""),
    "degree of half": replaced(r"^max_degree.*", "max_degree 70.5"),
    "huge degree": replaced(r"^max_degree.*", "max_degree 1000000"),
    "too high a degree": replaced(r"^max_degree.*", "max_degree 71"),
    "too low a degree": replaced(r"^max_degree.*", "max_degree 69"),
    "no end of the head": replaced(r"^end_of_head.*\n", ""),
    "another norm": replaced(r"^norm .*", "norm unnormalized"),
    "another product": replaced(r"^product_type.*", "product_type topography"),
    "a row twice, one missing": replaced(r"^gfc +3 +1 ", "gfc 3 2 "),
    "a word for a number": replaced(r"^gfc +3 +1 +\S+", "gfc 3 1 small"),
    "nan": replaced(r"^gfc +3 +1 +\S+", "gfc 3 1 nan"),
    "order above degree": replaced(r"^gfc +3 +1 ", "gfc 3 4 "),
    "negative order": replaced(r"^gfc +3 +1 ", "gfc 3 -1 "),
    "a key of no meaning": replaced(r"^gfc +3 +1 ", "gfz 3 1 "),
}
ACTIVITY = ANY_TEXT | {
    "no month": replaced(r"^ 2016\.58[\s\S]*", ""),
    "one month": replaced(r"^ 2016\.66[\s\S]*", ""),
    "a month missing": replaced(r"^ 2016\.75.*\n", ""),
    "a month twice": replaced("NOV", "OCT"),
    "no such month": replaced("OCT", "OKT"),
    "a word for a number": replaced("84.0", "high"),
    "a negative flux": replaced("84.0", "-84"),
    "a figure missing": replaced("84.0", "    "),
    "ends too early": replaced(r"^ 2016\.75[\s\S]*", ""),
    "begins too late": replaced(r"^ 2016\.5.*\n.*\n", ""),
}
WEATHER = ANY_TEXT | {
    "no heading": replaced(r"^DATE.*\n", ""),
    "no flux": replaced(r"F10.7_OBS,", "FLUX,"),
    "a day missing": replaced(r"^2016-09-30.*\n", ""),
    "no such day": replaced(r"^2016-09-30", "2016-09-31"),
    "a word for a number": replaced(r"^(2016-09-30,\d+),\d+", r"\1,quiet"),
    "a figure too few": replaced(r"^(2016-09-30,\d+).*", r"\1"),
    "infinite flux": replaced(r"^(2016-09-30.*),[\d.]+,OBS", r"\1,inf,OBS"),
    "ends too early": replaced(r"^2016-09-30[\s\S]*", ""),
}
KERNEL = ANY_TEXT | {
    "cut in the head": cut(0.001),
    "cut in the segments": cut(0.5),
    "cut at the end": cut(0.95),
    "another kind of DAF": lambda content: b"DAF/CK  " + content[8:],
    "another byte order": lambda content: content[:88] + b"VAX-GFLT" + content[96:],
}
FILES = {
    "gravity": ("gravity_field", "field.gfc", GRAVITY),
    "activity": ("solar_activity", "sun.txt", ACTIVITY),
    "weather": ("solar_activity", "sun.txt", WEATHER),
    "kernel": ("ephemerides", "week.bsp", KERNEL),
}
SHEETS = ("stations", "rsos")


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return sound_files(tmp_path_factory.mktemp("kernel"))


@pytest.fixture
def project(tmp_path):
    shutil.copytree(REPOSITORY / "config", tmp_path / "config")
    return tmp_path


def check(source):
    checks.check_data(source, checks.load_settings(source))


def refusal(project, files=(), on_top=None):
    """Return the one line with which a run in a folder would be refused before its first job."""
    with contextlib.chdir(project), pytest.raises(InputError) as error:
        check(merged(["config/config.yaml", *files], on_top))
    line = str(error.value)
    assert "\n" not in line
    return line


@pytest.mark.parametrize(("kind", "case"), [(kind, case) for kind, file in FILES.items() for case in file[2]])
def test_a_wrong_data_file_is_told_in_one_line(project, sound, kind, case):
    setting, name, changes = FILES[kind]
    (project / name).write_bytes(changes[case](sound[kind]))
    on_top = Layer(COMMAND_LINE, {"environment": {setting: name}})
    assert refusal(project, ["config/ci.yaml"], on_top).startswith(f"{name}: ")


def columns():
    for sheet in SHEETS:
        heading = (REPOSITORY / "config" / f"{sheet}.tsv").read_text().splitlines()[1]
        yield from ((sheet, column) for column in range(1, len(heading.split("\t"))))


@pytest.mark.parametrize("text", ["x", "nan", "-1e9"])
@pytest.mark.parametrize(("sheet", "column"), list(columns()))
def test_a_wrong_cell_is_told_in_one_line(project, sheet, column, text):
    path = project / "config" / f"{sheet}.tsv"
    *before, last = path.read_text().splitlines()
    row = last.split("\t")
    row[column] = text
    path.write_text("\n".join([*before, "\t".join(row)]) + "\n")
    assert refusal(project).startswith(f"config/{sheet}.tsv: ")


LEARNERS = ", ".join(paper_source().values["learners"])
ENTRIES = [
    ("{train: random-80}", "mine.test: expected a value, got none"),
    (
        "{train: random-80, test: rst}",
        "mine.test: expected seen, rest, days-<first>-<last> or days-<first>-<last>-unseen, got 'rst'",
    ),
    (
        "{train: days-0-30, test: days-40-60}",
        "mine.test: split 'days-40-60': expected ascending days up to duration_days, 50, got 40 and 60",
    ),
    (
        "{train: random-80, test: rest, learner: forest}",
        f"mine.learner: learner 'forest': expected one of {LEARNERS}; an svr may end in _s<kernel scale>",
    ),
    (
        "{train: random-80, test: rest, target: iss_i181}",
        "mine.target: RSO 'iss_i181': inclination: expected a number of at least 0 and at most 180, "
        "got '181'",
    ),
]
OVERLAYS = [
    (
        {"epoch": "1998-08-20T12:09:45"},
        "environment.solar_activity: MSAFE reaches from 1998-09-01 to 2041-10-01, "
        "this run needs 1998-08-20 to 1998-10-09; for other dates give the path of a bulletin",
    ),
    ({"epoch": "2016-02-30T00:00:00"}, "epoch: expected an instant that exists"),
    ({"epoch": "1957-10-04T19:28:34"}, "finals2000A"),
    ({"environment": {"ephemerides": "week.bsp"}}, "week.bsp: "),
    ({"environment": {"gravity_field": "none.gfc"}}, "none.gfc: expected an ICGEM file"),
    ({"environment": {"solar_activity": "none.txt"}}, "none.txt: expected a table"),
    ({"force_models": {"truth": {"degree": 71, "order": 71}}}, "EGM2008: degree: expected 0 to 70, got 71"),
]


@pytest.mark.parametrize(("entry", "message"), ENTRIES, ids=["no test", "test", "days", "learner", "target"])
def test_a_wrong_experiment_is_told_in_one_line(project, entry, message):
    (project / "mine.yaml").write_text(f"study: {{extends: [paper], evaluations: {{mine: {entry}}}}}\n")
    assert refusal(project, ["mine.yaml"]) == f"mine.yaml: study.evaluations.{message}"


@pytest.mark.parametrize(
    ("overlay", "beginning"),
    OVERLAYS,
    ids=["before the bulletin", "no day", "before the finals", "week", "no field", "no sun", "degree"],
)
def test_data_that_do_not_reach_far_enough_are_told_in_one_line(project, overlay, beginning):
    sound_files(project)  # a kernel of ten days, for a run of fifty
    assert refusal(project, on_top=Layer(COMMAND_LINE, overlay)).startswith(beginning)


def test_limits_of_elevation_that_are_swapped_are_told(project):
    path = project / "config" / "stations.tsv"
    path.write_text(path.read_text().replace("\t1\t90\t32.1", "\t90\t1\t32.1"))
    assert refusal(project) == (
        "config/stations.tsv: eglin: min_elevation_deg: expected less than max_elevation_deg, got 90 and 1"
    )
