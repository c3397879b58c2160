"""Pages that gather facts of others: messages are in the code, errors in tables; words of all pages."""

import re

import pytest
from support import REPOSITORY

from validation.pictures import page_tables

DOCS = REPOSITORY / "docs"
CODE = "\n".join(path.read_text(encoding="utf-8") for path in (REPOSITORY / "src" / "opml").rglob("*.py"))


def page(name):
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def messages():
    table = page("troubleshooting").split("## Messages")[1].split("## Symptoms")[0]
    return re.findall(r"^\| `([^`]+)` \|", table, re.MULTILINE)


@pytest.mark.parametrize("message", messages())
def test_each_message_is_one_of_the_code(message):
    known = {"config/config.yaml: no such file": "_PROJECT}: no such file"}
    assert known.get(message, message) in CODE


def row(name, start):
    """Cells of the row of a page that starts with a text."""
    (line,) = re.findall(rf"^\| {re.escape(start)}.*$", page(name), re.MULTILINE)
    return [cell.strip() for cell in line.strip("|").split("|")]


@pytest.mark.parametrize(
    ("start", "source"),
    [
        ("radar tracks (TDM): [every morning](day.md) | Swarm A", "Swarm A, 25"),
        ("radar tracks (TDM): [every morning](day.md) | Larets", "Larets, 58"),
    ],
    ids=["Swarm A", "Larets"],
)
def test_errors_by_data_are_those_of_real_satellites(start, source):
    told = row("inputs", start)[2:5]
    assert told == [cell.split("/")[0] for cell in row("reality", source)[1:4]]


def test_errors_of_the_orbit_inside_are_those_of_its_page():
    along = {day: ours.split(" / ")[1] for day, _, ours in page_tables.rows("docs/inside")[2:7]}
    assert row("inputs", "three weeks of element sets")[2:] == [along[day] for day in "137"]


def test_errors_of_element_sets_are_those_of_the_catalogue():
    told = row("inputs", "one element set")[2:5]
    lines = (DOCS / "tables" / "seasons.tsv").read_text(encoding="utf-8").splitlines()
    summer = [line.split("\t") for line in lines if line.startswith("summer")]
    medians = [float(cells[2]) for cells in summer]
    assert [float(number) for number in told] == [1000 * medians[k] for k in (0, 1, 3)]
    improved = [float(number) for number in row("inputs", "the same, improved")[2:5]]
    for k, number in zip((0, 1, 3), improved, strict=True):
        assert number == pytest.approx(10 * medians[k] * float(summer[k][-1].split()[0]), rel=0.02)


def test_errors_of_points_and_ranges_are_those_of_their_page():
    text = " ".join(page("tracks").split())
    day, week = row("inputs", "positions (GPS")[2:5:2]
    assert re.search(rf"`running24m3` after 1, 2, 4 and 7 days was {day}, \d+, \d+ and {week} m", text)
    day, week = row("inputs", "laser ranges")[2:5:2]
    assert f"0.14, {day}, 1.1, 3.1, {week} from later fits after 0.4, 1, 2, 4, 7 days" in text


def cells(heading):
    """Rows of the first table under a heading of the page that `make validate` writes."""
    text = page("tables/orekit").split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = re.search(r"(?:^\|.*\n)+", text, re.MULTILINE)[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in rows]


def test_what_the_validation_says_is_what_its_tables_have():
    text = " ".join(page("validation").split())
    forces = [row for row in cells("Term by term") if " " not in row[1]]
    assert max(float(row[1]) for row in forces) <= 1e-7
    assert "Every force term agrees to 1e-7 or better" in text
    (position,) = [row[1] for row in cells("Least squares") if row[0] == "position"]
    assert float(position.split()[0]) <= 0.2
    assert "fits of the same tracks to 0.2 m" in text
    steps = [row for row in cells("The integrator's own uncertainty") if row[0] != "lageos1"]
    week = [[float(cell) for cell in row[1:7]] for row in steps]
    assert max(max(row[::2]) for row in week) < 0.02
    assert "integration error is below 2 cm after seven days" in text
    assert 2.0 < min(min(row[1::2]) for row in week) < max(max(row[1::2]) for row in week) < 150.0
    assert "Orekit's 2 to 150 m in low orbits" in text
    apart = [float(cell) for row in cells("Orbits") if row[0] not in ("bound", "met") for cell in row[1:4]]
    assert max(apart) < 1.0
    assert "agree to a metre after seven days" in text


WORDS = re.compile(
    r"\b(?:tells?|told|leaves|flown|flew|flies|stands|stood|anew|beside|spoilt|nobody|nowhere|whom)\b"
    r"|\bof it\b|\bthe past (?:chose|chooses|left)\b|\bworth\b|\breadings?\b",
    re.IGNORECASE,
)
"""Words that have a better one in the trade: issued, propagated, remains, selected each day, ..."""

MOST = 5


def prose(text):
    return re.sub(r"(?s)```.*?```|^ {4}.*?$|`[^`]*`|\]\([^)]*\)", " ", text)


def test_pages_have_the_words_of_the_trade():
    found = {
        path.name: WORDS.findall(prose(path.read_text(encoding="utf-8")))
        for path in DOCS.glob("*.md")
        if not path.name.startswith("data")
    }
    assert sum(map(len, found.values())) <= MOST, {name: words for name, words in found.items() if words}
