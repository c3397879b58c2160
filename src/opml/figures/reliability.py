"""A figure of reliability: the share of errors inside stated bounds, against the share that was stated."""

from collections.abc import Mapping

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.base.errors import InputError
from opml.figures.axis_labels import clauses, symbol
from opml.figures.style import MARKERS, MUTED, RAMP, legend, panel_figure
from opml.tables import ELLIPSOID

_COLUMNS = 3  # panels side by side


def coverage_curves(tables: Mapping[str, pd.DataFrame], *, quantity: str, note: str = "") -> Figure:
    """Draw the share of errors inside [%] against the nominal share, a panel per model, a line per duration.

    Raises InputError without a table.

    tables: shares by the panel's title
    quantity: of those tables
    """
    if not tables:
        raise InputError("calibration: expected at least one model, got none")

    def draw(axes: Axes, name: str) -> None:
        table = tables[name]
        _draw_coverage(axes, table[table["quantity"] == quantity])

    figure = panel_figure(list(tables), draw, columns=_COLUMNS, heights_mm=(18.0, 54.0))
    bounds = "ellipsoids of the position" if quantity == ELLIPSOID else f"intervals of {symbol(quantity)}"
    figure.supxlabel("nominal share inside [%]", fontsize=8.0)
    figure.supylabel(f"share inside {bounds} [%]", fontsize=8.0)
    reading = "on the diagonal the stated share is true; below it what was stated is too small"
    legend(figure, columns=5, note=clauses(note, reading))
    return figure


def _draw_coverage(axes: Axes, table: pd.DataFrame) -> None:
    axes.plot([0.0, 100.0], [0.0, 100.0], color=MUTED, ls="--", lw=1.0, label="true", zorder=4)
    for k, (day, shares) in enumerate(table.groupby("day")):
        (line,) = axes.plot(100.0 * shares["level"], 100.0 * shares["inside"], ms=3.5, label=f"{day:g} d")
        line.set(color=RAMP[k % len(RAMP)], marker=MARKERS[k % len(MARKERS)])
    axes.set_xlim(0.0, 103.0)
    axes.set_ylim(0.0, 103.0)
    axes.set_xticks(range(0, 101, 25))
    axes.set_yticks(range(0, 101, 25))
    axes.set_aspect("equal")
