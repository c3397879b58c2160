"""When learning from a catalogue helps: what is left of SGP4's errors by height, drag and number of sets."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.figures.axis_labels import clauses
from opml.figures.style import MARKERS, MUTED, SERIES, add_head_and_legend, page_figure

LEAD = 3  # days from the morning to what is predicted, in the middle of those that the corrector knows
_GROUPS = 6  # groups of equally many predictions along an axis

_KEYS = ["number", "morning", "lead"]
_QUANTITIES = {
    "height": "height [km]",
    "drag": f"drag's displacement in {LEAD} days [km]",
    "judged": "judged predictions in ten mornings",
}


def gains(
    residuals: Mapping[str, pd.DataFrame], rows: Mapping[str, pd.DataFrame], labels: Mapping[str, str]
) -> Figure:
    """Draw the medians that are left [% of SGP4's] against three quantities, a line per test and way.

    residuals: `catalogue_residuals` of a learner, by test
    rows: `catalogue_rows`, by test
    labels: what each test is about
    """
    figure = page_figure(height_mm=88.0)
    panels = figure.subplots(1, len(_QUANTITIES), sharey=True)
    tables = {test: _joined(table, rows[test]) for test, table in residuals.items()}
    drawn: list[pd.DataFrame] = []
    for axes, (quantity, label) in zip(panels, _QUANTITIES.items(), strict=True):
        for k, (test, table) in enumerate(tables.items()):
            name = f"{labels[test]}, {table['number'].nunique()} objects".replace("\n", ", ")
            look = {"color": SERIES[k % len(SERIES)], "marker": MARKERS[k % len(MARKERS)], "label": name}
            drawn.append(_shares(table, quantity))
            _draw(axes, drawn[-1], look)
        axes.plot([], [], color=MUTED, marker="o", mfc="none", ls=":", label="density-scaled, not learned")
        axes.axhline(100.0, color=MUTED, lw=1.0, ls="--", label="SGP4")
        axes.set_xlabel(label)
    panels[1].set_xscale("log")
    panels[1].xaxis.set_major_formatter("{x:g}")
    panels[0].set_ylabel("median error [% of SGP4's]")
    learned = pd.concat(drawn)["learned"]
    reach = f"{learned.min():.0f} to {learned.max():.0f} %"
    headline = f"With learned corrections the median error after {LEAD} days is {reach} of SGP4's"
    note = clauses("filled: learned", "each mark is a sixth of a test's predictions")
    add_head_and_legend(figure, headline, note, columns=2)
    return figure


def _draw(axes: Axes, shares: pd.DataFrame, look: Mapping[str, Any]) -> None:
    axes.plot(shares.index, shares["learned"], lw=1.2, ms=3.5, **look)
    hollow: dict[str, Any] = {"mfc": "none", "ls": ":", "label": None}
    axes.plot(shares.index, shares["scaled"], lw=0.8, ms=3.5, **{**look, **hollow})


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
