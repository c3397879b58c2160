"""The page of a day: which objects to look at, how their ephemerides fared, what could not be run."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from datetime import date, timedelta
from typing import Any

from opml.base.progress import counted
from opml.mornings.calendar import HORIZON
from opml.mornings.outcomes import DO_NOT_USE, FAILED, GOOD, UNPROVEN, WIDE
from opml.report import texts
from opml.report.document import Block, Card, as_it_is
from opml.report.results import NO_VALUE, length, with_unit

Outcome = Mapping[str, Any]
Weather = Sequence[Mapping[str, Any]]  # of the days about a morning, as `weather_of_day.read` returns them
WORST_FIRST = (FAILED, DO_NOT_USE, WIDE, UNPROVEN, GOOD)  # verdicts, those to look at first
VERSION = 2  # of what the page for machines holds; another where a key goes or changes its meaning

TO_DO = {
    FAILED: "Do not send: failed",
    DO_NOT_USE: "Do not send",
    WIDE: "Send with care: wide",
    UNPROVEN: "Send with care: unproven",
    GOOD: "Send: good",
}
"""Actions for a message, by its verdict."""

SHAPES = {FAILED: "!", DO_NOT_USE: "\u2715", WIDE: "\u25d0", UNPROVEN: "\u25cb", GOOD: "\u25cf"}
"""Signs of verdicts in the row of the last mornings."""

CARDS = 200
"""Cards of a page at most, for the objects to look at first."""

LEADS = (1, 3, 7)  # days of duration whose errors the page states


def document(outcomes: Sequence[Outcome], weather: Weather, *, date: str) -> list[Block]:
    """Return the page of a date; outcomes: of all objects."""
    return [
        f"# {date}: {summary(outcomes)}",
        *_cards(outcomes),
        *texts.blocks("day.legend", shapes=", ".join(f"{SHAPES[word]} {word}" for word in SHAPES)),
        *in_figures(outcomes),
        *_past(outcomes),
        *space_weather(weather),
    ]


def _cards(outcomes: Sequence[Outcome]) -> Iterator[Block]:
    if len(outcomes) > CARDS:
        yield f"The {CARDS} to look at first have a card, [all](#in-figures) a line of the table."
    yield [card(outcome) for outcome in worst_first(outcomes)[:CARDS]]


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return how many objects have which verdict, in words."""
    counts = Counter(outcome["verdict"] for outcome in outcomes)
    parts = [f"{counts[verdict]} {verdict}" for verdict in WORST_FIRST if counts[verdict]]
    return f"{counted(len(outcomes), 'object')}: {', '.join(parts)}"


def as_json(outcomes: Sequence[Outcome], weather: Weather, *, date: str) -> dict[str, Any]:
    """Return the same for machines."""
    counts = Counter(outcome["verdict"] for outcome in outcomes)
    return {
        "version": VERSION,
        "date": date,
        "verdicts": {verdict: counts[verdict] for verdict in WORST_FIRST if counts[verdict]},
        "objects": list(outcomes),
        "weather": list(weather),
    }


def in_figures(outcomes: Sequence[Outcome]) -> Iterator[Block]:
    """Return the table of objects, and what it says."""
    leads = texts.across(f"error after {day} d [m]" for day in LEADS)
    return texts.blocks("day.objects", [_row(outcome) for outcome in worst_first(outcomes)], leads=leads)


def worst_first(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Return outcomes, those to look at first."""
    return sorted(
        outcomes, key=lambda entry: (WORST_FIRST.index(entry["verdict"]), -_miss(entry), entry["object"])
    )


def card(outcome: Outcome) -> Card:
    """Return the card of an object: what to do, why, the errors to expect, its last mornings."""
    name, word, why = outcome["object"], outcome["verdict"], as_it_is(_why(outcome))
    message = f"[{outcome['message']}]({name}/{outcome['message']})" if outcome["message"] else "none"
    last = [
        (SHAPES[morning["verdict"]], f"{morning['date']}: {morning['verdict']}", morning["verdict"])
        for morning in outcome["mornings"]
    ]
    return Card(
        name,
        TO_DO[word],
        word,
        [
            f"{why[:1].upper()}{why[1:]}.",
            f"Expected along the track, one sigma: {_expected(outcome)}.",
            *_sgp4_comparison(outcome),
            f"Message: {message}{_yesterday(outcome)}; newest estimate: {_newest(outcome)}; "
            f"model: {outcome['model'] or 'none'}.",
        ],
        last,
    )


def _expected(outcome: Outcome) -> str:
    sigmas = {size["day"]: size["along_track_sigma_m"] for size in outcome["expected"]}
    parts = [f"**{with_unit(sigmas[day])}** after {day} d" for day in LEADS if day in sigmas]
    return ", ".join(parts) or "none, as none was issued"


def _sgp4_comparison(outcome: Outcome) -> Iterator[str]:
    """Yield the errors of the selected models and of SGP4, where mean elements were taken."""
    by_day = {row["day"]: row for row in outcome["beside_sgp4"]}
    parts = [
        f"{with_unit(by_day[day]['flown_m'])} (SGP4 {with_unit(by_day[day]['sgp4_m'])}) after {day} d, "
        f"{counted(by_day[day]['mornings'], 'morning')}"
        for day in LEADS
        if day in by_day
    ]
    if parts:
        yield f"Median error so far: {'; '.join(parts)}."


def _newest(outcome: Outcome) -> str:
    if outcome["newest_estimate"] is None:
        return "none"
    age = "" if outcome["age_hours"] is None else f", {outcome['age_hours']:.0f} h old"
    return f"{_minute(outcome['newest_estimate'])}{age}"


def _yesterday(outcome: Outcome) -> str:
    """Return a link to the folder of the morning before, if there was one."""
    before = (date.fromisoformat(outcome["date"]) - timedelta(days=1)).isoformat()
    sent = (GOOD, WIDE, UNPROVEN)
    was_sent = any(row["date"] == before and row["verdict"] in sent for row in outcome["mornings"])
    is_there = outcome["message"] and was_sent
    return f"; [yesterday's](../{before}/{outcome['object']}/)" if is_there else ""


def _row(outcome: Outcome) -> list[str]:
    by_day = {score["day"]: score for score in outcome["scores"]}
    errors = [length(by_day[day]["along_track_m"]) if day in by_day else NO_VALUE for day in LEADS]
    count = sum(score["predictions"] for score in outcome["scores"])
    inside = sum(score["predictions"] * score["inside"] for score in outcome["scores"])
    return [
        outcome["object"],
        outcome["verdict"],
        f"`{outcome['model']}`" if outcome["model"] else NO_VALUE,
        _minute(outcome["newest_estimate"]) or NO_VALUE,
        f"{outcome['converged']} of {outcome['tracks']}",
        str(outcome["late"]),
        *errors,
        f"{100.0 * inside / count:.0f} %" if count else NO_VALUE,
        as_it_is(_why(outcome)),
    ]


def _why(outcome: Outcome) -> str:
    burn = f"; the tracks show a burn about {_minute(outcome['burn'])}" if outcome["burn"] else ""
    return f"{outcome['reason']}{burn}"


def _minute(time: str | None) -> str:
    """Return a time (UTC text) to the minute, '' for none."""
    return f"{time[:16]}Z" if time else ""


def _miss(outcome: Outcome) -> float:
    """Return the largest error of a day's scores [m], by which objects of one verdict are ordered."""
    return max((score["along_track_m"] for score in outcome["scores"]), default=0.0)


def _past(outcomes: Sequence[Outcome]) -> Iterator[Block]:
    rows = [
        [outcome["object"], verdict, *(_fared(scores, day) for day in LEADS)]
        for outcome in outcomes
        for verdict, scores in outcome["past"].items()
    ]
    leads = texts.across(f"{day} d" for day in LEADS)
    return texts.blocks("day.past", rows, horizon=HORIZON, leads=leads)


def _fared(scores: Sequence[Mapping[str, Any]], day: int) -> str:
    of_day = [score for score in scores if score["day"] == day]
    if not of_day:
        return NO_VALUE
    (score,) = of_day
    median, most = length(score["along_track_m"]), length(score["along_track_95_m"])
    return f"{median} / {most}, {100.0 * score['inside']:.0f} %"


def space_weather(weather: Weather) -> Iterator[Block]:
    """Return the weather about a morning, nothing where none is given."""
    rows = [_weather_row(row) for row in weather]
    return texts.blocks("day.weather", rows) if rows else iter(())


def _weather_row(row: Mapping[str, Any]) -> list[str]:
    figures = [_figure(row, name) for name in ("f107", "f107_mean", "kp_24h")]
    return [row["date"], "seen" if row["is_seen"] else "ahead", *figures]


def _figure(row: Mapping[str, Any], name: str) -> str:
    low, high = row[f"{name}_low"], row[f"{name}_high"]
    between = "" if low is None else f" ({low:.1f} to {high:.1f})"
    return f"{row[name]:.1f}{between}"
