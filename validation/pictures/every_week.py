"""The picture of docs/learning.md with what improved sets leave in each week: the worst one is named.

    python -m validation.pictures.every_week FOLDER/residuals

FOLDER is that of `python -m validation.catalogue_seasons`; its weeks become docs/tables/weeks.tsv.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.dates import DateFormatter, MonthLocator
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from opml.base import epochs
from opml.figures import style
from validation.pictures import shrunk
from validation.pictures.page_tables import tsv, write_seasons

SEASONS = {
    "summer": "summer of 2026",
    "storms": "storms of 2025",
    "rise": "rise of 2022",
}
"""Seasons of docs/learning.md; not those with few weeks or objects."""

LEADS = (1, 3, 5, 7)
FEWEST = 50
"""Least number of judged predictions of a week."""

_WEEK = 7
_TICKS = (25, 50, 75, 100, 150, 200, 300)


def weeks(residuals: pd.DataFrame, season: str) -> list[dict[str, object]]:
    """Return a row per week: season, its first day, and the share of SGP4's median left at each lead [%].

    residuals: of one season of `validation.catalogue_seasons`
    """
    sizes = residuals[["error", "improved"]].abs()
    week = (_WEEK * np.floor(residuals["morning"] / _WEEK)).rename("week")
    groups = sizes.groupby([week, residuals["lead"]])
    medians = groups.median()[groups.size() >= FEWEST]
    shares = (100.0 * medians["improved"] / medians["error"]).unstack().reindex(columns=LEADS).dropna()
    return [
        {"season": season, "week from": epochs.calendar(float(day))}
        | {_column(lead): f"{share:.0f}" for lead, share in row.items()}
        for day, row in shares.iterrows()
    ]


def _column(lead: int) -> str:
    return f"{lead} d [%]"


def every_week(table: Sequence[dict[str, str]]) -> Figure:
    """Draw the share of SGP4's median that improved sets leave: a panel per season, a mark per week, lead."""
    seasons = {season: [row for row in table if row["season"] == season] for season in SEASONS.values()}
    shares = [float(row[_column(lead)]) for row in table for lead in LEADS]
    figure = style.page_figure(height_mm=125.0)
    panels = figure.subplots(len(seasons), 1, sharey=True)
    for axes, (season, rows) in zip(panels, seasons.items(), strict=True):
        _draw(axes, rows)
        axes.set_title(f"{season}: {len(rows)} weeks", loc="left", fontsize=8.0)
    panels[0].set(yscale="log", ylim=(0.85 * min(shares), 1.6 * max(shares)))
    panels[0].yaxis.set_major_locator(FixedLocator(_TICKS))
    panels[0].yaxis.set_minor_locator(NullLocator())
    panels[0].yaxis.set_major_formatter("{x:g}")
    figure.supylabel("median error of improved sets [% of SGP4's]", fontsize=8.0)
    better = 100.0 * np.mean(np.array(shares) < 100.0)
    headline = f"Improved sets beat SGP4 in {better:.0f} % of all weeks and lead times"
    note = "objects not used in training; each season's worst week is named"
    style.add_head_and_legend(figure, headline, note, columns=5)
    return figure


def _draw(axes: Axes, rows: Sequence[dict[str, str]]) -> None:
    days = [np.datetime64(row["week from"]) for row in rows]
    for k, lead in enumerate(LEADS):
        look = {"color": style.RAMP[k], "marker": style.MARKERS[k], "label": f"after {lead} d"}
        axes.plot(days, [float(row[_column(lead)]) for row in rows], ms=3.0, lw=0.8, **look)
    axes.axhline(100.0, color=style.MUTED, lw=1.0, ls="--", label="SGP4")
    share, day, lead = worst(rows)
    axes.annotate(
        f"{share:.0f} % after {lead} d, week from {day}",
        (np.datetime64(day), share),
        (0.98, 0.97),
        textcoords="axes fraction",
        ha="right",
        va="top",
        fontsize=style.NOTE_SIZE,
        arrowprops={"arrowstyle": "-", "color": style.MUTED, "lw": 0.6},
    )
    axes.xaxis.set_major_locator(MonthLocator())
    axes.xaxis.set_major_formatter(DateFormatter("%Y-%m"))


def worst(rows: Sequence[dict[str, str]]) -> tuple[float, str, int]:
    """Return the largest share [%], the first day of its week, and its lead [d]."""
    return max((float(row[_column(lead)]), row["week from"], lead) for row in rows for lead in LEADS)


def main(folder: str) -> None:
    """Write the table, draw the picture and shrink it."""
    write_seasons("weeks", Path(folder), SEASONS, weeks)
    shrunk.save(every_week(tsv("weeks")), "weeks")


if __name__ == "__main__":
    main(*sys.argv[1:])
