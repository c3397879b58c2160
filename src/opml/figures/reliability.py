"""Nominal against achieved coverage of what was stated of later errors."""

import math
from collections.abc import Mapping

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.base.errors import InputError
from opml.figures.axis_labels import symbol
from opml.figures.style import MARKERS, MUTED, RAMP, legend, page_figure
from opml.tables import ELLIPSOID

COLUMNS = 3
"""Panels side by side."""


def coverage(tables: Mapping[str, pd.DataFrame], *, quantity: str, note: str = "") -> Figure:
    """Share of errors inside [%] against the nominal share, one panel per model and one line per duration.

    `tables`: `calibration` tables by the panel's title; `quantity`: one of theirs; `note`: what was tested.
    Raises InputError without a table.
    """
    if not tables:
        raise InputError("calibration: expected at least one model, got none")
    rows = math.ceil(len(tables) / COLUMNS)
    figure = page_figure(height_mm=18.0 + 54.0 * rows)
    panels = figure.subplots(rows, COLUMNS, squeeze=False, sharex=True, sharey=True).ravel()
    for axes, (name, table) in zip(panels, tables.items(), strict=False):
        _draw(axes, table[table["quantity"] == quantity])
        axes.set_title(name, fontsize=8.0, loc="left")
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels[len(tables) :]:
        axes.remove()
    what = "ellipsoids of the position" if quantity == ELLIPSOID else f"intervals of {symbol(quantity)}"
    figure.supxlabel("nominal share inside [%]", fontsize=8.0)
    figure.supylabel(f"share inside {what} [%]", fontsize=8.0)
    reading = "on the diagonal the stated share is true; below it what was stated is too small"
    legend(figure, columns=5, note="; ".join(filter(None, [note, reading])))
    return figure


def _draw(axes: Axes, table: pd.DataFrame) -> None:
    """The lines of one model, on the diagonal of what is true."""
    axes.plot([0.0, 100.0], [0.0, 100.0], color=MUTED, ls="--", lw=1.0, label="true", zorder=4)
    for k, (day, own) in enumerate(table.groupby("day")):
        (line,) = axes.plot(100.0 * own["level"], 100.0 * own["inside"], ms=3.5, label=f"{day:g} d")
        line.set(color=RAMP[k % len(RAMP)], marker=MARKERS[k % len(MARKERS)])
    axes.set_xlim(0.0, 103.0)
    axes.set_ylim(0.0, 103.0)
    axes.set_xticks(range(0, 101, 25))
    axes.set_yticks(range(0, 101, 25))
    axes.set_aspect("equal")
