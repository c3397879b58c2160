"""Every setting and every cell of the sheets made wrong, one at a time, through the real command line."""

import yaml
from project import ROOT, Project
from refusals import amiss

from opml.config import read_yaml

PAPER = read_yaml(ROOT / "config" / "config.yaml")
WRONG = [[]]  # no setting is a list of lists of nothing
CELLS = ("x", "nan", "-1e9")


def leaves(values, key=()):
    """Keys of all settings that are no mapping; of learners one of each kind."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from leaves(value, (*key, name))
        else:
            yield *key, name


def settings():
    kinds = {learner["kind"]: name for name, learner in PAPER["learners"].items()}
    for key in leaves(PAPER):
        if key[0] != "learners" or key[1] in kinds.values():
            yield key


def overlay(key):
    """Settings with one wrong value."""
    value = WRONG
    for name in reversed(key):
        value = {name: value}
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


def test_every_wrong_setting_is_told_in_one_line(tmp_path):
    cases = list(settings())
    assert len(cases) > 130
    assert amiss(cases, with_setting, tmp_path) == []


def test_every_wrong_cell_is_told_in_one_line(tmp_path):
    cases = list(cells())
    assert len(cases) > 50
    assert amiss(cases, lambda folder, case: with_cell(folder, *case), tmp_path) == []
