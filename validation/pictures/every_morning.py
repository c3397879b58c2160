"""The picture of docs/day.md: the verdicts of some months of mornings, day by day.

    opml day --date 2018-07-20 --configfile config/studies/mornings.yaml
    python -m validation.pictures.every_morning results/mornings BURNS

BURNS is a folder of the operators' lists of burns, `Sentinel-3A.yaml` for the object `sentinel3a`.
"""

import sys
from collections.abc import Iterable, Mapping, Sequence
from datetime import date
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.dates import DateFormatter, MonthLocator, date2num
from matplotlib.figure import Figure

from opml.base.yaml_files import read_yaml
from opml.figures import style
from opml.mornings import outcomes
from opml.mornings.outcomes import DO_NOT_USE, FAILED, GOOD, UNPROVEN, WIDE
from opml.orbits.manoeuvres import LISTED
from validation.pictures import shrunk

LOOKS = {
    GOOD: ("#B8DFD1", ""),
    UNPROVEN: ("#E3E3E3", "...."),
    WIDE: (style.HIGHLIGHT, "/////"),
    DO_NOT_USE: (style.RESIDUAL, "xxxxx"),
    FAILED: (style.PUBLISHED, "+++++"),
}
"""Colour and hatch of the days of a verdict."""

FIRST = 10
"""Mornings before the first that is shown: objects have hardly a past."""

SOON = 14
"""Days after a burn within which a verdict counts as its consequence."""


def verdicts(results: Path, names: Iterable[str]) -> pd.DataFrame:
    """Return the verdicts of mornings kept in a folder of results, a row a day, a column a satellite.

    names: of satellites, as a reader knows them
    """
    known = {name.replace("-", "").lower(): name for name in names}
    kept = sorted((results / "days").glob("*/batch_*/outcomes.json.gz"))
    rows = [
        (date.fromisoformat(one["date"]), known[one["object"]], one["verdict"])
        for path in kept
        for one in outcomes.read(path)
    ]
    table = pd.DataFrame(rows, columns=["date", "object", "verdict"])
    return table.pivot(index="date", columns="object", values="verdict")[FIRST:]


def burns(folder: Path) -> dict[str, list[date]]:
    """Return the dates of published burns by the satellite's name, as its file has it."""
    listed = {path.stem: read_yaml(path)[LISTED] or [] for path in sorted(folder.glob("*.yaml"))}
    return {name: [date.fromisoformat(str(time)[:10]) for time in times] for name, times in listed.items()}


def every_morning(table: pd.DataFrame, burnt: Mapping[str, Sequence[date]]) -> Figure:
    """Draw a row of days for each satellite, in two halves of the span.

    table: as `verdicts` returns it
    burnt: dates of burns by satellite
    """
    figure = style.page_figure(height_mm=34.0 + 9.5 * len(table.columns))
    names = list(table.columns)[::-1]
    for axes, part in zip(figure.subplots(2, 1), np.array_split(np.arange(len(table)), 2), strict=True):
        own = table.iloc[part]
        days = [date2num(day) for day in own.index]
        for height, name in enumerate(names):
            _draw_row(axes, height, days, own[name])
            at = [day for day in map(date2num, burnt[name]) if day in days]
            look = {"ls": "", "ms": 3.5, "color": style.TRUE_COLOR, "label": "published burn"}
            axes.plot(at, [height + 0.4] * len(at), "v", **look)
        axes.set(xlim=(days[0] - 0.5, days[-1] + 0.5), yticks=range(len(names)), yticklabels=names)
        axes.xaxis.set_major_locator(MonthLocator(bymonthday=(1, 8, 15, 22)))
        axes.xaxis.set_major_formatter(DateFormatter("%-d %b"))
        axes.grid(visible=False)
        axes.spines[:].set_visible(False)
    first, last = table.index[[0, -1]]
    known = "by public element sets and forecasts as they were known each day"
    note = f"{first} to {last}, {known}, after {FIRST} mornings without a past"
    style.add_head_and_legend(figure, headline(table, burnt), note, columns=1 + len(LOOKS))
    return figure


def _draw_row(axes: Axes, height: int, days: Sequence[float], words: pd.Series) -> None:
    """Draw the days of an object at a height, those of a verdict alike; days: as matplotlib counts them."""
    for word, (color, hatch) in LOOKS.items():
        at = [day for day, found in zip(days, words, strict=True) if found == word]
        look = {"color": color, "hatch": hatch, "edgecolor": "white", "linewidth": 0.0}
        axes.bar(at or [np.nan], 0.8, 0.9, height - 0.4, label=word, **look)  # its look is in the legend


def headline(table: pd.DataFrame, burnt: Mapping[str, Sequence[date]]) -> str:
    """Return in words how many mornings are good, and how many others follow a burn."""
    words = table.stack()
    others = words.index[words != GOOD]
    after = sum(any(0 <= (day - burn).days <= SOON for burn in burnt[name]) for day, name in others)
    good = f"{len(words) - len(others)} of {len(words)} mornings are {GOOD}"
    return f"{good}; {after} of {len(others)} others follow a burn within {SOON} days"


def main() -> None:
    """Draw the picture and shrink it."""
    results, folder = map(Path, sys.argv[1:])
    burnt = burns(folder)
    shrunk.save(every_morning(verdicts(results, burnt), burnt), "calendar")


if __name__ == "__main__":
    main()
