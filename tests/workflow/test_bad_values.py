"""Settings and cells of the sheets made wrong, one at a time, through the real command line."""

import yaml
from project import ROOT, Project
from refusals import amiss
from support import setting_keys

WRONG = [[]]  # no setting is a list of lists of nothing
CELLS = ("x", "nan", "-1e9")


def overlay(key):
    """Settings with one wrong value."""
    value = WRONG
    for name in reversed(key):
        value = {name: value}
    if key[0] == "study":
        value["study"]["extends"] = ["paper", "beyond"]
    return value


def with_setting(folder, key):
    """What is told of a wrong setting, and how the line should begin."""
    project = Project(folder)
    (folder / "bad.yaml").write_text(yaml.safe_dump(overlay(key)))
    return project.snakemake("-n", "--configfile=bad.yaml", check=False), f"opml: bad.yaml: {'.'.join(key)}"


def with_cell(folder, sheet, column, text):
    """What is told of a wrong cell of a sheet's last row, and how the line should begin."""
    project = Project(folder)
    path = folder / "config" / f"{sheet}.tsv"
    lines = path.read_text().splitlines()
    row = lines[-1].split("\t")
    row[column] = text
    path.write_text("\n".join([*lines[:-1], "\t".join(row)]) + "\n")
    return project.snakemake("-n", check=False), f"opml: config/{sheet}.tsv: "


def cells():
    for sheet in ("stations", "rsos"):
        heading = (ROOT / "config" / f"{sheet}.tsv").read_text().splitlines()[1].split("\t")
        for column in range(1, len(heading)):
            for text in CELLS:
                yield sheet, column, text


def test_wrong_settings_are_told_in_one_line(tmp_path):
    cases = setting_keys()[::4]  # tests/unit/study/test_settings.py has them all, in milliseconds
    assert len(cases) > 35
    assert amiss(cases, with_setting, tmp_path) == []


def test_every_wrong_cell_is_told_in_one_line(tmp_path):
    cases = list(cells())
    assert len(cases) > 50
    assert amiss(cases, lambda folder, case: with_cell(folder, *case), tmp_path) == []
