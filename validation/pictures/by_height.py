"""The picture of docs/inputs.md with what public sets are off by, by height and year.

    python -m validation.pictures.by_height FOLDER/residuals

FOLDER is that of `python -m validation.catalogue_seasons`; its medians become docs/tables/heights.tsv.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.element_sets.features import BANDS
from opml.figures import style
from opml.figures.ticks import metres
from validation.pictures import shrunk
from validation.pictures.page_tables import tsv, write_seasons

SEASONS = {"rise": "2022-11 to 2023-02", "storms": "2025-07 to 2026-01", "summer": "2026-06 to 07"}
"""Months by name in `validation.catalogue_seasons`."""

LEADS = (1, 3, 7)
FEWEST = 10
"""Least number of objects of a band."""


def heights(residuals: pd.DataFrame, months: str) -> list[dict[str, object]]:
    """Return a row per band and lead: its edges [km], how many objects, medians of SGP4 and improved [m].

    residuals: of one season of `validation.catalogue_seasons`
    """
    rows = []
    for (band, lead), part in residuals.groupby(["band", "lead"]):
        if lead in LEADS and (objects := part["number"].nunique()) >= FEWEST:
            low, high = (f"{edge / 1e3:.0f}" for edge in BANDS[[band, band + 1]])
            medians = part[["error", "improved"]].abs().median()
            sizes = {"SGP4 [m]": f"{medians['error']:.0f}", "improved [m]": f"{medians['improved']:.0f}"}
            row = {"months": months, "from [km]": low, "to [km]": high, "objects": objects, "days": lead}
            rows.append(row | sizes)
    return rows


def by_height(table: Sequence[dict[str, str]]) -> Figure:
    """Draw medians against the height, a panel per lead time, a line per season and kind of set."""
    figure = style.page_figure(height_mm=80.0)
    panels = figure.subplots(1, len(LEADS), sharey=True)
    for axes, lead in zip(panels, LEADS, strict=True):
        for k, months in enumerate(SEASONS.values()):
            rows = [row for row in table if (row["months"], row["days"]) == (months, str(lead))]
            _draw(axes, rows, {"color": style.SERIES[k], "marker": style.MARKERS[k], "ms": 4.0}, months)
        axes.set(yscale="log", xlabel="height [km]")
        axes.set_title(f"after {lead} d", loc="left", fontsize=8.0)
    panels[0].yaxis.set_major_formatter(FuncFormatter(metres))
    panels[0].set_ylabel("median along-track error")
    week = sorted(float(row["SGP4 [m]"]) for row in table if row["days"] == str(LEADS[-1]))
    least, most = (metres(float(f"{size:.2g}")) for size in (week[0], week[-1]))
    headline = f"SGP4's median error after a week: from {least} above 700 km to {most} below 400 km"
    note = "filled: SGP4; open: improved sets; objects not used in training, against later sets"
    style.add_head_and_legend(figure, headline, note, columns=3)
    return figure


def _draw(axes: Axes, rows: Sequence[dict[str, str]], look: dict[str, object], months: str) -> None:
    middle = [(float(row["from [km]"]) + float(row["to [km]"])) / 2.0 for row in rows]
    axes.plot(middle, [float(row["SGP4 [m]"]) for row in rows], label=months, **look)
    axes.plot(middle, [float(row["improved [m]"]) for row in rows], ls=":", mfc="none", **look)


def main(folder: str) -> None:
    """Write the table, draw the picture and shrink it."""
    write_seasons("heights", Path(folder), SEASONS, heights)
    shrunk.save(by_height(tsv("heights")), "heights")


if __name__ == "__main__":
    main(*sys.argv[1:])
