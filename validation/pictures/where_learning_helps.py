"""The picture of docs/learning.md on where learning helps, from tables of the pages.

python -m validation.pictures.where_learning_helps
"""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from opml.figures import style
from validation.pictures import shrunk
from validation.pictures.page_tables import catalogue, rows

LEADS = (1, 3, 5, 7)
"""Lead times of the catalogue's table [d]."""

_TICKS = (70, 80, 90, 100, 120, 150, 200, 300)


def from_catalogue() -> dict[str, list[float]]:
    """Return the trees' median error in % of that of density-scaled predictions, by season and lead time."""
    table = catalogue()
    seasons = dict.fromkeys(season for season, _ in table)
    return {
        season: [
            100.0 * trees[0] / scaled[0]
            for trees, scaled in zip(table[season, "trees"], table[season, "density-scaled"], strict=True)
        ]
        for season in seasons
    }


def from_own_past() -> dict[str, float]:
    """Return the summed error of the best model that learned, in % of the best without, by satellite."""
    skills = {}
    for name in ("Swarm A", "Larets"):
        (row,) = [cells for cells in rows("docs/reality", f"## {name}") if "best that learned" in cells[0]]
        skills[name] = row[-1]
    (row,) = [
        cells for cells in rows("notes/reality", "## Sentinel-3A and LAGEOS-2") if "learned" in cells[0]
    ]
    skills |= {"Sentinel-3A": row[4], "LAGEOS-2": row[7]}
    return {name: 100.0 - float(skill) for name, skill in skills.items()}


def gains(seasons: Mapping[str, Sequence[float]], satellites: Mapping[str, float]) -> Figure:
    """Draw errors with learning in % of those without, a row for each season and each satellite."""
    figure = style.page_figure(height_mm=86.0)
    axes = figure.add_subplot()
    names = [*seasons, *satellites]
    heights = dict(zip(names, np.arange(len(names))[::-1], strict=True))
    for k, lead in enumerate(LEADS):
        shares = [values[k] for values in seasons.values()]
        look = {"color": style.RAMP[k], "marker": style.MARKERS[k]}
        places = [heights[name] + 0.15 * (1.5 - k) for name in seasons]
        axes.plot(shares, places, ls="", label=f"catalogue, after {lead} d", **look)
    places = [heights[name] for name in satellites]
    axes.plot(
        list(satellites.values()),
        places,
        ls="",
        color=style.PREDICTED_COLOR,
        marker="P",
        label="own past, sum of all errors",
    )
    axes.axvline(100.0, color=style.MUTED, ls="--", lw=1.0, zorder=1)
    axes.set(xscale="log", xlabel="error with learning, in % of that without")
    axes.xaxis.set_major_locator(FixedLocator(_TICKS))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter("{x:g}")
    labels = [f"catalogue, {name.replace('; ', ': ')} objects" for name in seasons]
    axes.set_yticks(list(heights.values()), [*labels, *(f"{name} alone" for name in satellites)])
    axes.legend(loc="upper right", fontsize=style.NOTE_SIZE)
    note = (
        "catalogue: medians of trees relative to density-scaled sets, held-out objects; own past: "
        "best model that learned relative to the best without, all replayed mornings"
    )
    headline = "Learning from a catalogue helps in active years; from a satellite's own past it does not"
    style.add_head(figure, headline, note)
    return figure


def main() -> None:
    """Draw the picture and shrink it."""
    shrunk.save(gains(from_catalogue(), from_own_past()), "learning")


if __name__ == "__main__":
    main()
