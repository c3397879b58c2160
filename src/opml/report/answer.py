"""The report's first section: which model to use, its residual errors, the file to send, what to watch."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.learning.judge import calibration
from opml.learning.judge.errors_by_duration import at_days
from opml.learning.judge.model_choice import Mornings, summed
from opml.report import absurd_fits, texts, uncertainty
from opml.report.document import Block, Picture, items, link_to
from opml.report.mornings import TITLE as EVERY_MORNING
from opml.report.mornings import Dataset, days_within
from opml.report.skill import skill
from opml.tables import ELLIPSOID

TITLE = "Which model to use"

ALL_MODELS = "all models"  # what the figure shows that an answer holds

FEWEST = 10  # predictions of a duration below which neither their median nor a share of them is stated
MORNINGS = 14  # mornings below which the selection is poor: `opml docs operations`

_SPANS = {1.0: "a day", 7.0: "a week"}


@dataclass(frozen=True)
class Sources:
    """Files that the answer of a dataset points at."""

    files: Mapping[str, str]  # corrected ephemerides by model, as CCSDS OEM
    day: float  # of the newest estimate that they start from
    end: float  # day on which the run ends
    manoeuvres: str  # which are known, in words, '' of a simulated RSO, which makes none
    figures: Mapping[str, str]  # links to figures by what they show


def section(
    replays: Mapping[Dataset, Mornings],
    sources: Mapping[Dataset, Sources],
    pictures: Mapping[Dataset, FilePath],
    *,
    laws: Collection[str],
    marks: Sequence[float],
    durations: Sequence[float],
    absurd: Collection[Dataset],
    proof: Sequence[str],
) -> Iterator[Block]:
    """Yield the section.

    pictures: PNGs of the errors of all models
    laws: the models that learn
    marks: prediction durations that errors are stated at [days]
    durations: prediction durations that coverage is stated at [days]
    absurd: datasets whose fits are of no use
    proof: headings of the sections that the answers follow from
    """
    yield f"## {TITLE}"
    for (rso, stations), source in sources.items():
        mornings = replays.get((rso, stations))
        points = [f"**Why:** {', '.join(map(link_to, proof))}."]
        if mornings is None:
            verdict = "No morning was replayed, so no model can be recommended."
        else:
            chosen = mornings.last_choice
            parts = _left(mornings, marks), _held(mornings, durations), _others(mornings, laws)
            verdict = f"Use `{chosen}`: {' '.join(parts)}"
            file = texts.sentences("answer.file", path=source.files[chosen], day=source.day, end=source.end)
            points += [file, _training(mornings, laws)]
        points += _to_watch(mornings, source, durations, (rso, stations) in absurd)
        figures = ", ".join(f"[{shows}]({path})" for shows, path in source.figures.items())
        yield f"**{rso}, {stations}.** {verdict}"
        yield items([*points, f"**Figures:** {figures}."])
        if (rso, stations) in pictures:
            shows = f"Errors of {rso} by {stations}: before correction, as issued, and of each model"
            yield Picture(pictures[rso, stations], source.figures[ALL_MODELS], shows)


def _left(mornings: Mornings, marks: Sequence[float]) -> str:
    chosen = mornings.last_choice
    own = mornings.tables[chosen]
    sizes = at_days(own.assign(true=own["before"], residual=own["e_y"]), marks)
    counted = sizes[sizes["rows"] >= FEWEST] if len(sizes) else sizes
    names = [choice.chosen for choice in mornings.choices.values()]
    on = f"on {len(names)} mornings, selected on {names.count(chosen)} of them"
    if counted.empty:
        return f"no lead time has {FEWEST} predictions to state errors, {on}."
    words = [
        f"{_distance(row['after_50'])} after {_span(row['day'])} ({row['rows']} predictions)"
        for row in counted.iloc[[0, -1]].drop_duplicates("day").to_dict("records")
    ]
    return f"{', '.join(words)}, median along-track error {on}."


def _span(days: float) -> str:
    return _SPANS.get(days, f"{days:g} days")


def _distance(metres: float) -> str:
    """Return a length [m] in words, to two digits."""
    rounded = float(f"{metres:.2g}")
    return f"{rounded:g} m" if rounded < 1000.0 else f"{rounded / 1000.0:g} km"


def _held(mornings: Mornings, durations: Sequence[float]) -> str:
    shares = _ellipsoids(mornings, durations)
    if not shares:
        return uncertainty.TOO_SHORT
    low, high = (f"{100.0 * share:.0f}" for share in (min(shares.values()), max(shares.values())))
    return f"Its 90 % ellipsoid contains {low if low == high else f'{low} to {high}'} % of the errors."


def _ellipsoids(mornings: Mornings, durations: Sequence[float]) -> dict[float, float]:
    """Return shares of the errors of the selected models inside the 90 % ellipsoid, by duration [days]."""
    try:
        shares = calibration.of_replay(mornings.selected, days=durations)
    except InputError:  # the past was too short for a covariance
        return {}
    rows = shares[(shares["quantity"] == ELLIPSOID) & (shares["rows"] >= FEWEST)]
    return dict(zip(rows["day"], rows["inside"], strict=True))


def _others(mornings: Mornings, laws: Collection[str]) -> str:
    """Return in words what the best model without learning would have left, and the best that learned."""
    selected, words = summed(mornings.selected), []
    plain, learned = [[name for name in mornings.tables if (name in laws) is kind] for kind in (False, True)]
    for names, what in ((plain, "the best without learning"), (learned, "the best with learning")):
        if names:
            best = mornings.best(names)
            words.append(f"`{best}`, {what}, would have had {_more(summed(mornings.tables[best]), selected)}")
    few = (
        " So few mornings select poorly, four weeks select well." if len(mornings.choices) < MORNINGS else ""
    )
    against = "In hindsight, against the models selected each morning,"
    return f"{against} {' and '.join(words)}.{few} {_learned(mornings, laws)}"


def _learned(mornings: Mornings, laws: Collection[str]) -> str:
    learned = [choice.chosen in laws for choice in mornings.choices.values()]
    if any(learned):
        return f"A learned model was used on {sum(learned)} of {len(learned)} mornings."
    return "No learned model was used: on no morning did past results show that it would be better."


def _more(left: float, selected: float) -> str:
    percent = -round(skill(left, selected)) if selected > 0.0 else 0
    return f"{abs(percent)} % {'more' if percent > 0 else 'less'} error" if percent else "the same error"


def _training(mornings: Mornings, laws: Collection[str]) -> str:
    names = [choice.chosen for choice in mornings.choices.values()]
    changes = sum(new != old for old, new in pairwise(names))
    again = texts.sentences(f"answer.{'again' if names[-1] in laws else 'never'}", name=names[-1])
    return f"{again} On {changes} of {len(names)} mornings the selected model changed."


def _to_watch(
    mornings: Mornings | None, source: Sources, durations: Sequence[float], is_absurd: bool
) -> Iterator[str]:
    if is_absurd:
        yield f"**Watch the fits:** {link_to(absurd_fits.TITLE)}."
    if mornings is not None:
        yield f"**Watch the errors:** {days_within(mornings.selected)} {link_to(EVERY_MORNING)}"
        low, high = uncertainty.HOLDS
        outside = [
            f"{100.0 * share:.0f} % after {_span(day)}"
            for day, share in _ellipsoids(mornings, durations).items()
            if not low <= share <= high
        ]
        if outside:
            held = f"the 90 % ellipsoid contains {', '.join(outside)}"
            yield f"**Watch the covariance:** {held}. {link_to(uncertainty.TITLE)}"
    if source.manoeuvres:
        yield texts.sentences("answer.burns", manoeuvres=source.manoeuvres)
