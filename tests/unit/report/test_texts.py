"""Texts of reports: their pieces are those that the code names, and become blocks."""

import re
from importlib.resources import files

from support import REPOSITORY

from opml.report import texts
from opml.report.document import Table

REPORTS = REPOSITORY / "src" / "opml" / "report"


def test_each_piece_is_named_by_the_module_of_its_file_and_nothing_else_is():
    there = {
        f"{path.stem}.{name}"
        for path in (files("opml") / "data" / "reports").iterdir()
        for name in re.findall(r"^<!-- (\w+) -->$", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    code = {path.stem: path.read_text(encoding="utf-8") for path in REPORTS.rglob("*.py")}
    named = {f"{stem}.{name}" for stem in code for name in re.findall(rf'"{stem}\.(\w+)"', code[stem])}
    assert named <= there
    assert all(re.search(rf"\b{piece.split('.')[1]}\b", code[piece.split(".")[0]]) for piece in there - named)


def test_a_piece_is_headings_paragraphs_and_tables():
    heading, paragraph, table = texts.blocks("own_study.rows", [["x"]])
    assert heading == "## Rows used"
    assert paragraph == "A row is the prediction of one estimate to one later track."
    (table,) = texts.blocks("own_study.sizes", [["x"]], days=texts.across(["1 d", "2 d"]))
    assert table == Table(["RSO", "stations", "model", "learns", "1 d", "2 d", "skill, %"], [["x"]])
    (_, _, empty) = texts.blocks("reproduction.readings", names=texts.across([]))
    assert empty.header == ["interpretation"]
