"""The page of a day as a browser lays it out, on a desk and on a phone."""

from datetime import date

import pytest
from browser import laid_out

from opml.figures.style import save_png, screen_figure
from opml.mornings import days
from opml.mornings.outcomes import DO_NOT_USE, FAILED, GOOD, UNPROVEN, WIDE
from opml.report import day
from opml.report.document import Picture, html_page

WORDS = (GOOD, FAILED, UNPROVEN, DO_NOT_USE, WIDE)
STRIP = [{"date": f"2016-09-{k + 1:02}", "verdict": WORDS[k % len(WORDS)]} for k in range(30)]


def outcome(verdict):
    reason = "its 90 % intervals contained 61 % of the last errors on day 7 ahead, " * 2
    more = {"model": "running24m3", "message": "x.oem", "mornings": STRIP, "age_hours": 7.8}
    more["newest_estimate"] = "2016-10-04T22:10:00.000000"
    more["expected"] = [{"day": k, "along_track_sigma_m": 10.0**k} for k in (1, 3, 7)]
    more["beside_sgp4"] = [
        {"day": k, "flown_m": 10.0**k, "sgp4_m": 20.0**k, "mornings": 9 - k} for k in (1, 3, 7)
    ]
    name = verdict.replace(" ", "")
    return days.failed(name, date(2016, 10, 5), verdict, reason) | more


@pytest.fixture(scope="module", params=[390, 1280], ids=["phone", "desk"])
def seen(request, tmp_path_factory):
    """Return a width [px] and what a browser says of the page at it."""
    page = html_page(day.document([outcome(word) for word in WORDS], [], date="2016-10-05"), title="day")
    return request.param, laid_out(page, tmp_path_factory.mktemp("browser"), width=request.param)


def test_nothing_that_matters_is_off_the_screen(seen):
    width, page = seen
    assert page["across"] <= width
    assert all(0 <= left < right <= width for _, left, right, _ in page["cards"])
    assert page["marks"] == [0] * len(WORDS)
    *_, first = page["cards"][0]
    assert first < 900


def test_those_to_look_at_come_first_in_their_colours(seen):
    _, page = seen
    assert [name for name, *_ in page["cards"]] == ["failed", "donotuse", "wide", "unproven", "good"]
    assert page["lines"][0] == page["lines"][1]
    assert len(set(page["lines"])) == len(WORDS) - 1


@pytest.mark.parametrize(("width", "least"), [(390, 330), (1280, 600)])
def test_a_figure_for_screens_is_large_and_all_of_it_is_seen(width, least, tmp_path):
    save_png(screen_figure(), tmp_path / "screen.png")
    page = html_page([Picture(tmp_path / "screen.png", "screen.png", "errors")], title="study")
    seen = laid_out(page, tmp_path, width=width)
    assert seen["across"] <= width
    ((_, right),) = seen["pictures"]
    assert least < right <= width
