"""Numbers in sentences are those of the tables of the same page, or of the page that they are from."""

import re

import pytest
from support import REPOSITORY

SEASONS = ("summer of 2026", "2025-07-01", "2022-11-01", "2018 to 2020", "fragments")


def page(name):
    return (REPOSITORY / f"{name}.md").read_text(encoding="utf-8")


def sentences(name):
    return " ".join(page(name).split())


def rows(name, heading=""):
    """Cells of the rows of tables under a heading of a page, or of all."""
    text = page(name).partition(f"\n{heading}\n")[2].partition("\n## ")[0] if heading else page(name)
    lines = re.findall(r"^\| .* \|$", text, re.MULTILINE)
    return [[cell.strip() for cell in line[1:-1].split(" | ")] for line in lines]


def seasons():
    """Numbers of the table of learning.md by season and way: median, 95th percentile, interval of the median."""
    table, season = {}, ""
    for first, way, *cells in rows("docs/learning", "## Results"):
        season = next((name for name in SEASONS if first.startswith(name)), season)
        table[season, way.strip("*")] = [[int(n) for n in re.findall(r"\d+", cell)] for cell in cells]
    return table


def test_the_share_of_sgp4_s_error_is_that_of_the_catalogue():
    week = [seasons()[season, "improved"][-1][0] for season in SEASONS]
    assert f"after a week to {min(week[:3])} to {max(week[:3])} %" in sentences("docs/reality")
    assert f"at solar minimum they do not ({week[3]} %)" in sentences("docs/reality")


def test_each_median_of_improved_sets_is_inside_its_interval():
    for season in SEASONS:
        for median, _, low, high in seasons()[season, "improved"]:
            assert low <= median <= high


def test_trees_relative_to_density_are_those_of_the_rows():
    summer = "summer of 2026"
    ratios = [
        100.0 * trees[0] / density[0]
        for trees, density in zip(
            seasons()[summer, "trees"], seasons()[summer, "density-scaled"], strict=True
        )
    ]
    said = re.search(r"trees have ((?:\d+ \(\d+ to \d+\)(?:, | and )?){4}) %", sentences("docs/learning"))[1]
    stated = [tuple(map(int, numbers)) for numbers in re.findall(r"(\d+) \((\d+) to (\d+)\)", said)]
    for ratio, (middle, low, high) in zip(ratios, stated, strict=True):
        assert ratio == pytest.approx(middle, abs=2.0)
        assert low <= ratio <= high


def test_what_learning_costs_a_satellite_is_the_skill_of_its_table():
    table = {first: cells for first, *cells in rows("docs/reality", "## Swarm A")}
    skill = int(table["`mechanism`, the best that learned"][-1])
    assert f"retrained each morning it is {-skill} % worse than the best" in sentences("docs/reality")
    larets = rows("docs/reality", "## Larets")[-1]
    assert "the best that learned" in larets[0]
    assert max(skill, int(larets[-1])) < 0
    assert "No model that learned from one satellite's own past did better" in sentences("docs/reality")


def test_what_a_coarser_field_costs_is_in_the_notes():
    (chosen,) = [cells for cells in rows("notes/reality", "## Swarm A") if cells[0] == "chosen by the past"]
    day, _, four, week = (cell.split(" / ")[0] for cell in chosen[1:5])
    assert f"errors of {day}, {four} and {week} m after 1, 4 and 7 days" in sentences("docs/reality")


def test_the_storm_is_covered_as_long_as_the_table_has_it():
    (storm,) = [cells for cells in rows("docs/uncertainty", "## Results") if cells[0].startswith("storm")]
    shares = [int(cell.split(" %")[0]) for cell in storm[2:]]
    assert min(shares[:3]) >= 85 > shares[3]
    assert "That of March 2015 is covered for five days" in sentences("docs/uncertainty")


def alarms(start):
    """Alarms per collision, and shares flagged [%], of the row that starts with a text."""
    (cells,) = [
        cells for cells in rows("docs/conjunctions", "## How much corrections help") if cells[0] == start
    ]
    return [tuple(map(int, cell.split(" / "))) for cell in cells[1:]]


def test_corrected_ephemerides_raise_a_tenth_of_the_alarms():
    fits, selected = (
        alarms("Swarm A, 12-hour fits, their own covariance"),
        alarms("Swarm A, selected each day"),
    )
    assert selected[0][0] / fits[0][0] == pytest.approx(0.1, abs=0.02)
    assert "After a day, corrected ephemerides raise a tenth of the alarms" in sentences("docs/conjunctions")
    assert [share for _, share in selected] == [100] * 4
    assert fits[-1][1] < 50


def test_alarms_are_those_of_the_notes():
    even = {
        cells[0]: [round(float(cell.split(",")[0])) for cell in cells[2:]]
        for cells in rows("notes/conjunctions", "## Draws")
        if cells[1:2] == ["even"]
    }
    assert [count for count, _ in alarms("Swarm A, 12-hour fits")] == even[
        "12-hour fits, covariance of past errors"
    ]
    own = alarms("Swarm A, 12-hour fits, their own covariance")
    assert [count for count, _ in own] == even["12-hour fits, the fit's own"]
    larets = next(cells for cells in rows("notes/conjunctions", "## Draws") if "Larets, chosen" in cells[0])
    assert [tuple(map(int, cell.split(" / "))) for cell in larets[2:]] == alarms("Larets, selected each day")


def test_every_conjunction_of_cara_is_counted_once():
    inside, all_of_them = re.search(
        r"Of (\d+) conjunctions of NASA's CARA (\d+) are within", sentences("docs/conjunctions")
    ).groups()[::-1]
    assert int(inside) + len(re.findall(r"one is 2 % low|one 12 % high", page("docs/conjunctions"))) == int(
        all_of_them
    )
    assert f"the probabilities of {all_of_them} real conjunctions" in sentences("docs/conjunctions")
