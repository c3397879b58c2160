"""The page of a day with many objects: counts, a map, those one watches, the worst, all to download."""

from datetime import date

import numpy as np
import pytest
from browser import laid_out

from opml.figures import style
from opml.figures.catalogue.expected_errors import expected_errors
from opml.mornings import days
from opml.mornings.outcomes import DO_NOT_USE, FAILED, GOOD, UNPROVEN, WIDE
from opml.report.catalogue_pages import day_of_many
from opml.report.document import Table, html_page, markdown

COUNT = 1000
WORDS = [GOOD] * 15 + [WIDE] * 3 + [UNPROVEN] * 2


def outcome(number, rng):
    """What became of an object: every hundredth failed, every fiftieth is not to be used."""
    word = FAILED if number % 100 == 0 else DO_NOT_USE if number % 50 == 0 else WORDS[number % len(WORDS)]
    height = float(rng.choice([420.0, 550.0, 800.0, 1200.0]) + 30.0 * rng.normal())
    told = days.failed(
        f"o{number}", date(2026, 3, 2), word, "its 90 % intervals contained 91 % of the last errors"
    )
    if word == FAILED:
        return told
    sigma = round(float(3e4 * np.exp(-(height - 400.0) / 100.0) + 20.0), 1)
    mornings = [{"date": "2026-03-01", "verdict": GOOD}]
    told |= {"expected": [{"day": day, "along_track_sigma_m": sigma * day} for day in (1, 3, 7)]}
    told |= {"height_km": height, "inclination_deg": float(rng.choice([53.0, 74.0, 98.0]) + rng.normal())}
    return told | {"model": "density", "mornings": mornings, "past": {"all": []}}


@pytest.fixture(scope="module")
def outcomes():
    rng = np.random.default_rng(1)
    return [outcome(number, rng) for number in range(COUNT)]


@pytest.fixture(scope="module")
def page(outcomes, tmp_path_factory):
    picture = tmp_path_factory.mktemp("page") / "day.png"
    style.save_png(expected_errors(outcomes), picture)
    watched = ["o1", "o50"]
    return day_of_many.document(outcomes, [], date="2026-03-02", watched=watched, picture=picture)


def test_verdicts_are_counted(page):
    counts = next(block for block in page if isinstance(block, Table))
    assert [row[0] for row in counts.rows] == [FAILED, DO_NOT_USE, WIDE, UNPROVEN, GOOD]
    assert counts.rows[0][2:] == ["10", "1.0 %"]
    assert sum(int(row[2]) for row in counts.rows) == COUNT


def test_the_worst_have_a_line_and_those_that_are_watched_a_card(page):
    *_, worst = (block for block in page if isinstance(block, Table))
    assert len(worst.rows) == day_of_many.WORST
    assert [row[1] for row in worst.rows[:21]] == [FAILED] * 10 + [DO_NOT_USE] * 10 + [WIDE]
    text = markdown(page)
    assert "**o1. " in text
    assert "**o50. Do not send**" in text
    assert "**o2. " not in text
    assert "## The 100 to look at first" in text


def test_without_watched_objects_there_is_no_such_section(outcomes):
    page = day_of_many.document(outcomes, [], date="2026-03-02", watched=[], picture="day.png")
    assert "Watched" not in markdown(page)


def test_every_object_is_in_the_table_and_on_the_page_for_machines(outcomes):
    assert len(day_of_many.table(outcomes).rows) == COUNT
    page = day_of_many.as_json(outcomes, [], date="2026-03-02")
    assert page["verdicts"][FAILED] == 10
    assert page["objects"][1] == outcomes[1] | {"mornings": None, "past": None}


def test_the_map_has_a_mark_for_each_object_with_an_ephemeris(outcomes):
    (marks,) = expected_errors(outcomes).axes[0].collections
    assert len(marks.get_offsets()) == COUNT - 10
    largest = marks.get_offsets()[-1]
    assert float(largest[1]) == min(one["height_km"] for one in outcomes if one["height_km"])
    assert not expected_errors(outcomes[:1]).axes[0].collections


@pytest.mark.parametrize("width", [390, 1280])
def test_the_page_fits_a_screen(page, tmp_path, width):
    seen = laid_out(html_page(page, title="day"), tmp_path, width=width)
    assert seen["across"] <= width
    assert all(right <= width for _, right in seen["pictures"])
