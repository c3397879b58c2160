"""The report's section on replayed mornings: the errors that an operator would have had, model by model."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.learning.judge.errors_by_duration import at_days
from opml.learning.judge.model_choice import CHOSEN, CONFIDENCE, Mornings, summed
from opml.report import on_the_sky
from opml.report.document import Block, Heading, Paragraph, Table
from opml.report.results import NO_VALUE, length
from opml.report.skill import NO_CORRECTION, skill_cell

Dataset = tuple[str, str]  # RSO and station set

TITLE = "Every morning"


def section(
    replays: Mapping[Dataset, Mornings], marks: Sequence[float], laws: Sequence[str]
) -> Iterator[Block]:
    """Yield the section, nothing where no morning was replayed.

    marks: prediction durations that errors are stated at [days]
    laws: the models that learn
    """
    if not replays:
        return
    yield Heading(TITLE)
    yield Paragraph(
        "Each morning every model is retrained on the errors known by then, and the day's estimates are "
        "predicted and corrected without information from after t_i. |e_y| [m] at some lead times, median "
        "/ 95th percentile, and skill [%] relative to the best model without learning, known in hindsight "
        "only. The model is also selected each morning: the one without learning with the smallest past "
        f"error, or a learned one if it is better at {100.0 * CONFIDENCE:g} % confidence, over blocks of "
        "days."
    )
    for (rso, stations), mornings in replays.items():
        yield Paragraph(f"**{rso}, {stations}.** {_verdict(mornings, laws)}")
        yield Table(["model", *(f"{day:g} d" for day in marks), "skill, %"], _rows(mornings, marks, laws))
        yield from on_the_sky.section(mornings.flown, marks)


def _verdict(mornings: Mornings, laws: Sequence[str]) -> str:
    """Return as text what was flown, and what it left beside the best model without learning."""
    best, least = best_model(mornings, laws)
    skill = skill_cell(summed(mornings.flown), least)
    names = [choice.chosen for choice in mornings.choices.values()]
    flown = ", ".join(f"`{name}` {number}" for name, number in Counter(names).most_common())
    sure = sum(name in laws for name in names)
    begin, end = (time / DAY for time in (min(mornings.choices), max(mornings.choices)))
    return (
        f"The models selected each day have a skill of {skill} % relative to `{best}`, the best without "
        f"learning. On {len(mornings.choices)} mornings, days {begin:g} to {end:g}: {flown}; on "
        f"{sure} past results showed that learning helps. {len(mornings.flown)} predictions; "
        f"{mornings.earlier} more began before all models were available, and are not counted."
        f"{_of_burns(mornings.flown)}"
    )


def _of_burns(flown: pd.DataFrame) -> str:
    """Return as text how many rows of a `replay` table a burn spoilt before it was known, if any."""
    spoilt = int(np.isfinite(flown["spoilt"]).sum()) if "spoilt" in flown else 0
    if not spoilt:
        return ""
    return (
        f" {spoilt} predictions crossed a burn, or began with a fit across it, before it was known: they "
        "count here, but later they train no law and do not influence the choice of models and error sizes."
    )


def best_model(mornings: Mornings, laws: Sequence[str]) -> tuple[str, float]:
    """Return the best model without learning, which is known in hindsight only, and the |e_y| that it left.

    |e_y| is summed over all predictions [m].
    """
    best = mornings.best([name for name in mornings.tables if name not in laws])
    return best, summed(mornings.tables[best])


def _rows(mornings: Mornings, marks: Sequence[float], laws: Sequence[str]) -> list[list[str]]:
    _, least = best_model(mornings, laws)
    before = mornings.flown.assign(e_y=mornings.flown["before"])
    tables = {NO_CORRECTION: before} | {
        f"`{name}`": table for name, table in mornings.tables.items() if name != "none"
    }
    return [_row(name, table, marks, least) for name, table in (tables | {CHOSEN: mornings.flown}).items()]


def _row(name: str, table: pd.DataFrame, marks: Sequence[float], least: float) -> list[str]:
    grown = at_days(
        pd.DataFrame({"duration": table["duration"], "true": table["before"], "residual": table["e_y"]}),
        marks,
    )
    sizes = {row["day"]: row for row in grown.to_dict("records")}
    cells = [
        f"{length(sizes[day]['after_50'])} / {length(sizes[day]['after_95'])}" if day in sizes else NO_VALUE
        for day in marks
    ]
    return [name, *cells, skill_cell(summed(table), least)]
