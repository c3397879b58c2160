"""A map of the errors that a day's ephemerides state, by inclination and height."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from opml.figures.style import MUTED, add_note, screen_figure

DAY = 1
"""Days ahead of the errors that are drawn."""


def expected_errors(outcomes: Sequence[Mapping[str, Any]]) -> Figure:
    """Draw a mark for each object that has an ephemeris, coloured by one sigma along the track after a day.

    outcomes: what became of objects
    """
    rows = _rows(outcomes)
    figure = screen_figure()
    axes = figure.subplots()
    axes.set_xlabel("inclination [deg]")
    axes.set_ylabel("mean height [km]")
    axes.set_yscale("log", subs=())
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    note = f"{len(rows)} of {len(outcomes)} objects have an ephemeris"
    if len(rows):
        rows = rows.sort_values("sigma")  # the largest on top
        low, high = np.percentile(rows["sigma"], [1.0, 99.0])
        size = float(np.clip(3000.0 / len(rows), 3.0, 30.0))
        colours = LogNorm(low, max(high, 1.01 * low))
        look = {"c": rows["sigma"], "s": size, "norm": colours, "cmap": "cividis_r", "linewidths": 0.0}
        marks = axes.scatter(rows["inclination"], rows["height"], **look)
        bar = figure.colorbar(marks, ax=axes, extend="both")
        bar.set_label(f"one sigma along the track after {DAY} d [m]")
        bar.outline.set_edgecolor(MUTED)
    add_note(figure, note)
    return figure


def _rows(outcomes: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return inclination [deg], height [km] and sigma [m] of the objects that have all of these."""
    rows = [
        (one["inclination_deg"], one["height_km"], ahead["along_track_sigma_m"])
        for one in outcomes
        for ahead in one["expected"]
        if ahead["day"] == DAY and one["height_km"] is not None
    ]
    return pd.DataFrame(rows, columns=["inclination", "height", "sigma"])
