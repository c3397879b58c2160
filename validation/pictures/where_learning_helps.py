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

_TICKS = (100, 150, 200, 300)


def from_catalogue() -> dict[str, list[list[int]]]:
    """Return the trees' median error in % of that of density-scaled predictions, by season and lead time.

    Where there are intervals of 95 %, their ends follow.
    """
    return {season: shares for (season, way), shares in catalogue().items() if way == "trees to density"}


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


def gains(seasons: Mapping[str, Sequence[Sequence[int]]], satellites: Mapping[str, float]) -> Figure:
    """Draw errors with learning in % of those without: a panel of seasons, one of satellites."""
    figure = style.page_figure(height_mm=78.0)
    many, own = figure.subplots(1, 2, width_ratios=(3, 2))
    for k, lead in enumerate(LEADS):
        look = {"color": style.RAMP[k], "marker": style.MARKERS[k], "label": f"after {lead} d"}
        for row, shares in enumerate(seasons.values()):
            middle, low, high = (*shares[k], *shares[k], *shares[k])[:3]
            reach = [[middle - low], [high - middle]]
            place = -row + 0.16 * (1.5 - k)
            many.errorbar(middle, place, xerr=reach, ls="", ms=4.0, elinewidth=0.8, capsize=1.5, **look)
    many.set_yticks(-np.arange(len(seasons)), list(seasons))
    many.set_title("trained on a catalogue", loc="left", fontsize=8.0)
    look = {"ls": "", "marker": "P", "color": style.PREDICTED_COLOR}
    own.plot(list(satellites.values()), -np.arange(len(satellites)), **look)
    own.set_yticks(-np.arange(len(satellites)), list(satellites))
    own.set_title("trained on the satellite's own past", loc="left", fontsize=8.0)
    for axes in (many, own):
        axes.axvline(100.0, color=style.MUTED, ls="--", lw=1.0, zorder=1)
    own.set(xscale="log", xlim=(90.0, 400.0), ylim=(0.5 - len(satellites), 0.5))
    own.xaxis.set_major_locator(FixedLocator(_TICKS))
    own.xaxis.set_minor_locator(NullLocator())
    own.xaxis.set_major_formatter("{x:g}")
    figure.supxlabel("error with learning [% of that without]", fontsize=8.0)
    note = (
        "left: median of trees relative to density-scaled sets, objects not used in training, with 95 % "
        "intervals (none at minimum); right: best model that learned relative to the best that did not"
    )
    sure = sum(max(max(share) for share in shares) < 100 for shares in seasons.values())
    headline = f"Trees help for sure in {sure} season of {len(seasons)}; one satellite's own past never does"
    style.add_head_and_legend(figure, headline, note, columns=4)
    return figure


def main() -> None:
    """Draw the picture and shrink it."""
    shrunk.save(gains(from_catalogue(), from_own_past()), "learning")


if __name__ == "__main__":
    main()
