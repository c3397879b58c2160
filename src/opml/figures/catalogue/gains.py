"""When learning from a catalogue helps: what is left of SGP4's errors by height, drag and number of sets."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.figures.axis_labels import clauses
from opml.figures.style import MARKERS, MUTED, SERIES, legend, page_figure

LEAD = 3  # days from the morning to what is predicted, in the middle of those that the corrector knows
_GROUPS = 6  # groups of equally many predictions along an axis

_KEYS = ["number", "morning", "lead"]
_QUANTITIES = {
    "height": "height [km]",
    "drag": f"drag's displacement in {LEAD} days [km]",
    "judged": "judged predictions in ten mornings",
}


def gains(residuals: Mapping[str, pd.DataFrame], rows: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the medians that are left [% of SGP4's] against three quantities, a line per test and way.

    residuals: `catalogue_residuals` of a learner, by test
    rows: `catalogue_rows`, by test
    """
    figure = page_figure(height_mm=78.0)
    panels = figure.subplots(1, len(_QUANTITIES), sharey=True)
    tables = {test: _joined(table, rows[test]) for test, table in residuals.items()}
    for axes, (quantity, label) in zip(panels, _QUANTITIES.items(), strict=True):
        axes.axhline(100.0, color=MUTED, lw=1.0, ls="--", label="SGP4")
        for k, (test, table) in enumerate(tables.items()):
            _draw(
                axes,
                _shares(table, quantity),
                test,
                {"color": SERIES[k % len(SERIES)], "marker": MARKERS[k % len(MARKERS)]},
            )
        axes.set_xlabel(label)
    panels[1].set_xscale("log")
    panels[0].set_ylabel("left of SGP4's error [%]")
    note = clauses(f"medians {LEAD} days ahead", "each mark is a sixth of all")
    legend(figure, columns=3, note=note)
    return figure


def _draw(axes: Axes, shares: pd.DataFrame, test: str, look: Mapping[str, Any]) -> None:
    axes.plot(shares.index, shares["learned"], lw=1.2, ms=3.5, label=f"{test}, learned", **look)
    hollow: dict[str, Any] = {"markerfacecolor": "none", "ls": ":", "label": f"{test}, density-scaled"}
    axes.plot(shares.index, shares["scaled"], lw=0.8, ms=3.5, **look, **hollow)


def _joined(residuals: pd.DataFrame, rows: pd.DataFrame) -> pd.DataFrame:
    """Return the residuals of LEAD with the quantities."""
    own = residuals[residuals["lead"] == LEAD].merge(rows[[*_KEYS, "height", "drag"]], on=_KEYS)
    mornings = own["morning"].nunique()
    judged = own.groupby("number")["morning"].transform("size")
    return own.assign(
        height=own["height"] / 1e3, drag=np.exp(own["drag"]) / 1e3, judged=10.0 * judged / mornings
    )


def _shares(table: pd.DataFrame, quantity: str) -> pd.DataFrame:
    """Return what each way leaves [%], by the median of a quantity in groups of equally many predictions."""
    group = pd.qcut(table[quantity], _GROUPS, labels=False, duplicates="drop")
    sizes = table[["error", "scaled", "learned"]].abs().groupby(group).median()
    shares = 100.0 * sizes[["scaled", "learned"]].div(sizes["error"], axis=0)
    return shares.set_index(table[quantity].groupby(group).median())
