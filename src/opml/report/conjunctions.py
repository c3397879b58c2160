"""The report's section on what predictions are worth where objects may collide."""

from collections.abc import Iterator, Mapping

import pandas as pd

from opml.learning.data.error_components import UNCORRECTED
from opml.learning.judge.model_choice import CHOSEN
from opml.report import texts
from opml.report.document import Block
from opml.report.mornings import Dataset
from opml.report.results import NO_VALUE
from opml.report.skill import NO_CORRECTION
from opml.tables import ANY_CROSSING

TITLE = "Benefit in conjunctions"
_NAMES = {UNCORRECTED: NO_CORRECTION, CHOSEN: CHOSEN}


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
        shown = table[(table["crossing"] == ANY_CROSSING) | (table["model"] == CHOSEN)]
        rows = [
            [_NAMES.get(str(model), f"`{model}`"), *map(str, others), *_cells(found, days)]
            for (model, *others), found in shown.groupby(
                ["model", "covariance", "weather", "crossing"], sort=False
            )
        ]
        names = {"rso": rso, "stations": stations, "days": texts.across(f"{day:g} d" for day in days)}
        yield from texts.blocks("conjunctions.dataset", rows, **names)


def _cells(found: pd.DataFrame, days: list[float]) -> list[str]:
    by_day = found.assign(flagged=100.0 * found["flagged"]).set_index("day")
    cell = "{alarms:.0f} / {per_approach:.2g} / {flagged:.0f}".format
    return [cell(**by_day.loc[day]) if day in by_day.index else NO_VALUE for day in days]
