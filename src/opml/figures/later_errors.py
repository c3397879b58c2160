"""Errors of one object's ephemeris as an operator sees them: against estimates of later tracks."""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.style import MUTED, RESIDUAL, TRUE_COLOR, legend, page_figure
from opml.figures.ticks import metres
from opml.orbits.rsw_covariance import half_width

_AXES = {"x": "radial", "y": "along-track", "z": "cross-track"}
_BEFORE: dict[str, Any] = {
    "mec": TRUE_COLOR,
    "mfc": "none",
    "mew": 0.7,
    "marker": "o",
    "ms": 4.5,
    "label": "no correction",
}
_AFTER: dict[str, Any] = {"color": RESIDUAL, "marker": "^", "ms": 2.4, "label": "corrected"}
"""Looks of the points; rings stay in sight where both are the same."""


def later_errors(errors: pd.DataFrame, *, level: float, note: str = "") -> Figure:
    """Draw the errors of one ephemeris by duration [d]; one row per axis of RSW.

    On the left are the prediction and its correction, on the right the correction alone in the band of its
    covariance. Raises InputError where nothing was measured later.

    errors: as `corrected.held_against` returns
    level: share of the errors that the band should hold
    """
    if errors.empty:
        raise InputError("ephemeris: expected an estimate of a later track to hold it against, got none")
    figure = page_figure(height_mm=144.0)
    panels = figure.subplots(3, 2, sharex=True)
    for (left, right), (axis, name) in zip(panels, _AXES.items(), strict=True):
        days, before, after = errors["duration"] / DAY, errors[f"before_{axis}"], errors[f"after_{axis}"]
        _draw(left, days, before, _BEFORE)
        _draw(left, days, after, _AFTER)
        _draw_band(right, errors, axis, level)
        _draw(right, days, after, _AFTER)
        for axes in (left, right):
            axes.yaxis.set_major_formatter(FuncFormatter(metres))
        left.set_ylabel(f"{name} error")
    titles = ("before and after the correction", "after it, in its band")
    for axes, title in zip(panels[0], titles, strict=True):
        axes.set_title(title, fontsize=8.0, loc="left")
    figure.supxlabel(r"time since the estimate $\Delta t$ [d]", fontsize=8.0)
    figure.supylabel("predicted less later estimate, in RSW of the estimate", fontsize=8.0)
    legend(figure, columns=3, note=note)
    return figure


def _draw(axes: Axes, days: pd.Series, errors: pd.Series, look: dict[str, Any]) -> None:
    axes.axhline(0.0, color=MUTED, lw=0.7)
    axes.plot(days, errors, ls="", **look)


def _draw_band(axes: Axes, errors: pd.DataFrame, axis: str, level: float) -> None:
    """Draw the interval about zero that the correction's covariance gives."""
    half = half_width(level) * errors[f"sigma_{axis}"]
    days, label = errors["duration"] / DAY, f"{100.0 * level:g} % by its covariance"
    axes.fill_between(days, -half, half, color=RESIDUAL, alpha=0.18, lw=0.0, label=label)
