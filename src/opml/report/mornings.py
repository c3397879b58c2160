"""The report's section on replayed mornings: the errors that an operator would have had, model by model."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.learning.judge.errors_by_duration import REACH_DAYS, at_days
from opml.learning.judge.model_choice import CHOSEN, CONFIDENCE, Mornings, summed
from opml.report import texts
from opml.report.document import Block
from opml.report.results import NO_VALUE, length
from opml.report.skill import NO_CORRECTION, skill_cell

Dataset = tuple[str, str]  # RSO and station set

TITLE = "Every morning"

BOUND = 1000.0  # along-track error [m] that a prediction's use is counted up to
SHARE = 0.9  # share of the errors that sizes hold


def section(
    replays: Mapping[Dataset, Mornings], marks: Sequence[float], laws: Sequence[str]
) -> Iterator[Block]:
    """Yield the section, nothing where no morning was replayed.

    marks: prediction durations that errors are stated at [days]
    laws: the models that learn
    """
    if not replays:
        return
    yield from texts.blocks("mornings.section", title=TITLE, confidence=100.0 * CONFIDENCE)
    for (rso, stations), mornings in replays.items():
        names = {"rso": rso, "stations": stations, "verdict": _verdict(mornings, laws)}
        days = texts.across(f"{day:g} d" for day in marks)
        yield from texts.blocks("mornings.dataset", _rows(mornings, marks, laws), **names, days=days)


def _verdict(mornings: Mornings, laws: Sequence[str]) -> str:
    best, least = best_model(mornings, laws)
    skill = skill_cell(summed(mornings.selected), least)
    names = [choice.chosen for choice in mornings.choices.values()]
    selected = ", ".join(f"`{name}` {number}" for name, number in Counter(names).most_common())
    verdict = texts.sentences(
        "mornings.verdict",
        skill=skill,
        best=best,
        mornings=len(mornings.choices),
        begin=min(mornings.choices) / DAY,
        end=max(mornings.choices) / DAY,
        selected=selected,
        sure=sum(name in laws for name in names),
        predictions=len(mornings.selected),
        earlier=mornings.earlier,
    )
    across = (
        int(np.isfinite(mornings.selected["burn_known"]).sum()) if "burn_known" in mornings.selected else 0
    )
    return f"{verdict} {texts.sentences('mornings.burns', across=across)}" if across else verdict


def best_model(mornings: Mornings, laws: Sequence[str]) -> tuple[str, float]:
    """Return the best model without learning, which is known in hindsight only, and the |e_y| that it left.

    |e_y| is summed over all predictions [m].
    """
    best = mornings.best([name for name in mornings.tables if name not in laws])
    return best, summed(mornings.tables[best])


def _rows(mornings: Mornings, marks: Sequence[float], laws: Sequence[str]) -> list[list[str]]:
    _, least = best_model(mornings, laws)
    before = mornings.selected.assign(e_y=mornings.selected["before"])
    tables = {NO_CORRECTION: before} | {
        f"`{name}`": table for name, table in mornings.tables.items() if name != "none"
    }
    return [_row(name, table, marks, least) for name, table in (tables | {CHOSEN: mornings.selected}).items()]


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


def days_within(selected: pd.DataFrame) -> str:
    """Return in words for how long nine tenths of the errors of a `replay` table stay within BOUND."""
    step = 2.0 * REACH_DAYS
    number = np.round(selected["duration"] / DAY / step)
    passed = selected["e_y"].abs().groupby(number).quantile(SHARE) > BOUND
    if not passed.any():
        return "90 % stay within 1 km for the whole prediction."
    days = (float(passed.idxmax()) - 1.0) * step
    if passed.iloc[0] or days <= 0.0:
        return "More than 10 % exceed 1 km from the beginning on."
    return f"90 % stay within 1 km for {days:g} days."
