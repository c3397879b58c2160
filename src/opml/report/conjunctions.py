"""The report's section on what predictions are worth where objects may collide."""

from collections.abc import Iterator, Mapping

import pandas as pd

from opml.learning.data.components import UNCORRECTED
from opml.learning.judge.model_choice import CHOSEN
from opml.report import texts
from opml.report.document import Block
from opml.report.mornings import Dataset
from opml.report.results import NO_VALUE
from opml.report.skill import NO_CORRECTION

TITLE = "Benefit in conjunctions"


def section(tables: Mapping[Dataset, pd.DataFrame], screening: Mapping[str, float]) -> Iterator[Block]:
    """Yield the section, nothing where it was not asked for.

    tables: `conjunctions`
    screening: radius_m and threshold
    """
    if not tables:
        return
    yield from texts.blocks("conjunctions.section", title=TITLE, **screening)
    for (rso, stations), table in tables.items():
        days = list(dict.fromkeys(table["day"]))
        rows = [
            [_named(str(model)), str(covariance), str(weather), *_cells(found, days)]
            for (model, covariance, weather), found in table.groupby(
                ["model", "covariance", "weather"], sort=False
            )
        ]
        names = {"rso": rso, "stations": stations, "days": texts.across(f"{day:g} d" for day in days)}
        yield from texts.blocks("conjunctions.dataset", rows, **names)


def _named(model: str) -> str:
    names = {UNCORRECTED: NO_CORRECTION, CHOSEN: CHOSEN}
    return names.get(model, f"`{model}`")


def _cells(found: pd.DataFrame, days: list[float]) -> list[str]:
    by_day = found.set_index("day")
    return [
        f"{by_day.loc[day, 'alarms']:.0f} / {100.0 * by_day.loc[day, 'flagged']:.0f}"
        if day in by_day.index
        else NO_VALUE
        for day in days
    ]
