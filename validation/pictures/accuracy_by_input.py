"""The picture of docs/inputs.md, from its table: python -m validation.pictures.accuracy_by_input."""

import re
from collections.abc import Mapping

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from opml.figures import style
from opml.figures.line_ends import name_ends
from opml.figures.ticks import metres
from validation.case import ROOT
from validation.pictures import shrunk

PAGE = ROOT / "docs" / "inputs.md"
LEADS = (1, 3, 7)
"""Lead times of the table's columns [d]."""

_KINDS = {
    "one element set (TLE, OMM)": ("SGP4, one element set", style.TRUE_COLOR, "o"),
    "the same, improved": ("improved element set", style.ESTIMATE, "D"),
    "three weeks of element sets": ("orbit inside element sets", style.PREDICTED_COLOR, "s"),
    "radar tracks (TDM)": ("radar tracks", style.RESIDUAL, "^"),
    "positions (GPS, 10 m)": ("GPS positions", style.HIGHLIGHT, "v"),
    "laser ranges (CRD)": ("laser ranges", style.OBSERVED_COLOR, "P"),
}
"""Names and looks of the kinds of data, by the first cell of their rows."""


_MANY = ("459 satellites", "the same")
"""Objects that are no single satellite."""


def table() -> dict[tuple[str, str], dict[int, float]]:
    """Return the errors [m] by lead time [d] of the rows of the page that have some, by kind and object."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if re.match(r"\| [a-z].* \|", line)
    ]
    found = {
        (re.sub(r" by a \[.*|: \[.*", "", kind), body.split(",")[0]): {
            lead: float(size) for lead, size in zip(LEADS, sizes, strict=True) if re.match(r"[\d.]+$", size)
        }
        for kind, body, *sizes in rows
    }
    return {key: errors for key, errors in found.items() if errors}


def accuracy(errors: Mapping[tuple[str, str], Mapping[int, float]]) -> Figure:
    """Draw errors along the track [m] by lead time [d], a line for each kind of data and object."""
    figure = style.page_figure(height_mm=90.0)
    axes = figure.add_subplot()
    ends, colors = {}, {}
    for (kind, body), sizes in errors.items():
        name, color, marker = _KINDS[kind]
        label = name if body in _MANY else f"{name}, {body}"
        ends[label], colors[label] = sizes[LEADS[-1]], color
        is_whole = len(sizes) == len(LEADS)
        axes.plot(list(sizes), list(sizes.values()), color=color, marker=marker, ls="-" if is_whole else ":")
    axes.set(xscale="log", yscale="log", xlim=(0.9, 7.5), xlabel="lead time [d]")
    axes.set_xticks(LEADS, [str(lead) for lead in LEADS])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    axes.set_ylabel("along-track error")
    name_ends(axes, ends, colors)
    note = "numbers of the table below; dotted: not measured in between; months and references differ"
    style.add_head(axes.figure, "Better data and higher orbits: from kilometres to metres", note)
    return figure


def main() -> None:
    """Draw the picture and shrink it."""
    shrunk.save(accuracy(table()), "inputs")


if __name__ == "__main__":
    main()
