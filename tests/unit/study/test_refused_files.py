"""Files, cells of the sheets and settings made wrong, one at a time: each is told in one line."""

import contextlib
import re
import shutil

import pytest
import support
from data_files import sound_files
from support import REPOSITORY, paper_source

from opml.study import checks
from opml.study.settings.merging import merged
from opml.study.settings.overlay import COMMAND_LINE, Layer

ANY_TEXT = {
    "empty": lambda content: b"",
    "zeros": lambda content: bytes(1000),
    "text": lambda content: b"Not found\n",
    "html": lambda content: b"<!DOCTYPE html><title>404</title>",
    "picture": lambda content: b"\x89PNG\r\n\x1a\n" + bytes(range(256)),
}
TOO_SHORT = ANY_TEXT | {
    "ends too early": lambda content: re.split(rb"\n(?: 2016\.75|2016-09-30)", content)[0]
}
FILES = {
    "gravity": ("gravity_field", "field.gfc", ANY_TEXT),
    "activity": ("solar_activity", "sun.txt", TOO_SHORT),
    "weather": ("solar_activity", "sun.txt", TOO_SHORT),
}
SHEETS = ("stations", "rsos")


@pytest.fixture(scope="module")
def sound():
    return sound_files()


@pytest.fixture
def project(tmp_path):
    shutil.copytree(REPOSITORY / "config", tmp_path / "config")
    return tmp_path


def check(source):
    checks.check_data(source, checks.load_settings(source))


def refusal(project, files=(), on_top=None):
    """Return the one line with which a run in a folder would be refused before its first job."""
    with contextlib.chdir(project):
        return support.refusal(check, merged(["config/config.yaml", *files], on_top))


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
        f"mine.learner: learner 'forest': expected one of {LEARNERS}",
    ),
    (
        "{train: random-80, test: rest, target: iss_i181}",
        "mine.target: RSO 'iss_i181': inclination: expected a number of at least 0 and at most 180, "
        "got '181'",
    ),
]
OVERLAYS = [
    ({"epoch": "2016-02-30T00:00:00"}, "epoch: expected an instant that exists"),
    ({"epoch": "1957-10-04T19:28:34"}, "finals2000A"),
    ({"environment": {"gravity_field": "none.gfc"}}, "none.gfc: no such file"),
    ({"environment": {"solar_activity": "none.txt"}}, "none.txt: no such file"),
    ({"force_models": {"truth": {"degree": 71, "order": 71}}}, "EGM2008: degree: expected 0 to 70, got 71"),
]


@pytest.mark.parametrize(("entry", "message"), ENTRIES, ids=["no test", "test", "days", "learner", "target"])
def test_a_wrong_experiment_is_told_in_one_line(project, entry, message):
    (project / "mine.yaml").write_text(f"study: {{extends: [paper], evaluations: {{mine: {entry}}}}}\n")
    assert refusal(project, ["mine.yaml"]) == f"mine.yaml: study.evaluations.{message}"


@pytest.mark.parametrize(
    ("overlay", "beginning"), OVERLAYS, ids=["no day", "before the finals", "no field", "no sun", "degree"]
)
def test_data_that_do_not_reach_far_enough_are_told_in_one_line(project, overlay, beginning):
    assert refusal(project, on_top=Layer(COMMAND_LINE, overlay)).startswith(beginning)


def test_limits_of_elevation_that_are_swapped_are_told(project):
    path = project / "config" / "stations.tsv"
    path.write_text(path.read_text().replace("\t1\t90\t32.1", "\t90\t1\t32.1"))
    assert refusal(project) == (
        "config/stations.tsv: eglin: min_elevation_deg: expected less than max_elevation_deg, got 90 and 1"
    )
