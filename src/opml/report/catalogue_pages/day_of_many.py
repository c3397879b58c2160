"""The page of a day with more objects than anybody reads cards of: counts, those one watches, the worst."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from opml.base.files import FilePath
from opml.report import day, texts
from opml.report.day import WORST_FIRST, Outcome, Weather
from opml.report.document import Block, Picture, Table

MOST = 200
"""Objects that a page has cards of."""

WORST = 100
"""Objects in the page's table, those to look at first."""

_DETAILS = ("mornings", "past")
"""Facts of an object that `opml day --object` shows and the page for machines leaves out."""


def document(
    outcomes: Sequence[Outcome], weather: Weather, *, date: str, watched: Sequence[str], picture: FilePath
) -> list[Block]:
    """Return the page of a date.

    outcomes: of all objects
    watched: names of those that have a card
    picture: file of the map of expected errors, next to the page
    """
    cards = [day.card(one) for one in day.worst_first(outcomes) if one["object"] in set(watched)]
    blocks: list[Block] = [
        f"# {date}: {day.summary(outcomes)}",
        *texts.blocks("day_of_many.counts", _counts(outcomes), table="day.tsv"),
        *texts.blocks("day_of_many.map"),
        [Picture(picture, "day.png", "one sigma along the track after a day, by orbit")],
    ]
    if cards:
        blocks += [*texts.blocks("day_of_many.watched"), cards]
    blocks += texts.blocks("day_of_many.worst", worst=min(WORST, len(outcomes)))
    return [*blocks, *day.in_figures(day.worst_first(outcomes)[:WORST]), *day.space_weather(weather)]


def table(outcomes: Sequence[Outcome]) -> Table:
    """Return the table of all objects, those to look at first."""
    return next(block for block in day.in_figures(outcomes) if isinstance(block, Table))


def as_json(outcomes: Sequence[Outcome], weather: Weather, *, date: str) -> dict[str, Any]:
    """Return the same for machines."""
    short = [one | dict.fromkeys(_DETAILS) for one in map(dict, outcomes)]
    return day.as_json(short, weather, date=date)


def _counts(outcomes: Sequence[Outcome]) -> list[list[str]]:
    counts = Counter(one["verdict"] for one in outcomes)
    shares = {word: f"{100.0 * counts[word] / len(outcomes):.1f} %" for word in WORST_FIRST}
    return [[word, day.TO_DO[word], str(counts[word]), shares[word]] for word in WORST_FIRST]
