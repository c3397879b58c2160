"""The page of a day: those to look at first, what was flown, and the same for machines."""

from datetime import date

import pytest

from opml.mornings import days
from opml.report import day
from opml.report.document import Table, html_page, markdown

SCORE = {"day": 1, "predictions": 5, "along_track_m": 40.0, "along_track_95_m": 90.0, "inside": 0.8}


def outcome(name, verdict, **more):
    scores = {"scores": [SCORE], "past": {"all": [SCORE], "good": [SCORE]}}
    return days.failed(name, date(2016, 10, 5), verdict, "why") | scores | {"model": "fit96"} | more


OUTCOMES = [
    outcome(
        "first",
        "good",
        message="first.oem",
        newest_estimate="2016-10-04T22:10:00.000000",
        age_hours=7.8,
        beside_sgp4=[
            {"day": 1, "flown_m": 40.0, "sgp4_m": 310.0, "mornings": 12},
            {"day": 2, "flown_m": 90.0, "sgp4_m": 900.0, "mornings": 11},
            {"day": 3, "flown_m": 150.0, "sgp4_m": 12_400.0, "mornings": 1},
        ],
        expected=[{"day": 1, "along_track_sigma_m": 93.0}, {"day": 7, "along_track_sigma_m": 15_320.0}],
        mornings=[{"date": "2016-10-04", "verdict": "unproven"}, {"date": "2016-10-05", "verdict": "good"}],
    ),
    outcome("second", "do not use"),
    outcome("third", "good", scores=[SCORE | {"along_track_m": 900.0}]),
    outcome("fourth", "failed", scores=[], past={}, model=""),
]
FIGURES = {"f107": 67.25, "f107_mean": 70.0, "kp_24h": 2.0}
RANGES = {"f107_low": 60.0, "f107_high": 90.0, "f107_mean_low": 69.0, "f107_mean_high": 72.0}
RANGES |= {"kp_24h_low": 1.0, "kp_24h_high": 4.0}
WEATHER = [
    {"date": "2016-10-05", "is_seen": True} | FIGURES | dict.fromkeys(RANGES),
    {"date": "2016-10-06", "is_seen": False} | FIGURES | RANGES,
]


@pytest.fixture(scope="module")
def page():
    return markdown(day.document(OUTCOMES, WEATHER, date="2016-10-05"))


def test_those_to_look_at_come_first(page):
    places = [page.index(f"| {name} |") for name in ("fourth", "second", "third", "first")]
    assert places == sorted(places)
    assert "4 objects: 1 failed, 1 do not use, 2 good" in page


def test_what_was_flown_is_told_by_verdict(page):
    past = page[page.index("Past performance") :]
    assert "| first | good | 40 / 90, 80 % | - | - |" in past
    assert "fourth" not in past


def test_a_card_says_what_to_do(page):
    cards = page[: page.index("## In figures")]
    assert "**second. Do not send**" in cards
    assert "**first. Send: good**" in cards
    assert "Why." in cards
    assert "Expected along the track, one sigma: **93 m** after 1 d, **15 km** after 7 d." in cards
    assert (
        "Message: [first.oem](first/first.oem); [yesterday's](../2016-10-04/first/); "
        "newest estimate: 2016-10-04T22:10Z, 8 h old; model: fit96." in cards
    )
    assert "newest estimate: none" in cards
    assert cards.count("\u25cb\u25cf\n") == 1


def test_sgp4_stands_beside_an_object_of_public_sets_alone(page):
    parts = "40 m (SGP4 310 m) after 1 d, 12 mornings; 150 m (SGP4 12 km) after 3 d, 1 morning"
    beside = f"Median error so far: {parts}."
    assert page.count("so far: ") == page.count(beside) == 1


def test_a_browser_gets_the_same_cards():
    made = html_page(day.document(OUTCOMES, WEATHER, date="2016-10-05"), title="")
    assert made.count('<section class="do-not-use">') == 1
    assert '<span class="unproven" title="2016-10-04: unproven">\u25cb</span>' in made
    assert '<a href="first/first.oem">first.oem</a>' in made


def test_machines_get_the_same():
    found = day.as_json(OUTCOMES, WEATHER, date="2016-10-05")
    assert list(found["verdicts"].items()) == [("failed", 1), ("do not use", 1), ("good", 2)]
    assert found["version"] == day.VERSION
    assert found["objects"] == OUTCOMES
    assert found["weather"] == WEATHER


def test_the_weather_that_was_seen_stands_before_what_is_ahead(page):
    assert "| 2016-10-05 | seen | 67.2 | 70.0 | 2.0 |" in page
    assert "| 2016-10-06 | ahead | 67.2 (60.0 to 90.0) | 70.0 (69.0 to 72.0) | 2.0 (1.0 to 4.0) |" in page


LINE = "expected KEY, got [show the log](javascript:alert(1)) **b** [x](//evil) [y](https://evil)"


def test_a_damaged_file_marks_nothing_up():
    blocks = day.document([outcome("a", "failed", reason=LINE)], WEATHER, date="2016-10-05")
    made = html_page(blocks, title="")
    assert "expected KEY, got (show the log)(javascript:alert(1))" in made
    assert "href" not in made
    assert "<strong>" not in made


@pytest.mark.parametrize(
    ("text", "link"),
    [
        ("[a](#there)", '<a href="#there">a</a>'),
        ("[a](https://example.org/x)", '<a href="https://example.org/x">a</a>'),
        ("[a](figs/one.png)", '<a href="figs/one.png">a</a>'),
        ("[a](javascript:alert)", "[a](javascript:alert)"),
        ("[a](data:text/html,x)", "[a](data:text/html,x)"),
        ("[a](//example.org)", "[a](//example.org)"),
    ],
)
def test_links_lead_to_places_alone(text, link):
    assert f"<p>{link}</p>" in html_page([text], title="")


def test_only_the_worst_of_many_objects_have_a_card():
    many = [outcome(f"o{number}", "good") for number in range(day.CARDS)] + [outcome("bad", "failed")]
    page = day.document(many, [], date="2016-10-05")
    cards = next(block for block in page if isinstance(block, list))
    assert len(cards) == day.CARDS
    assert cards[0].title == "bad"
    assert "The 200 to look at first have a card" in markdown(page)
    assert len(next(block for block in page if isinstance(block, Table)).rows) == len(many)
