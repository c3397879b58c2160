"""Errors of one object's ephemeris as an operator sees them: against estimates of later tracks."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.style import MUTED, RESIDUAL, TRUE_COLOR, add_head_and_legend, page_figure
from opml.figures.ticks import metres, rounded
from opml.orbits.rsw_covariance import half_width

_AXES = {"x": "radial", "y": "along-track", "z": "cross-track"}
_BEFORE: dict[str, Any] = {"mec": TRUE_COLOR, "mfc": "none", "mew": 0.7, "marker": "o", "ms": 4.5}
_AFTER: dict[str, Any] = {"color": RESIDUAL, "marker": "^", "ms": 2.4, "label": "corrected"}
"""Looks of the points; rings stay in sight where both are the same."""


def later_errors(errors: pd.DataFrame, *, level: float, note: str = "") -> Figure:
    """Draw the errors of one ephemeris by duration [d]; one row per axis of RSW.

    On the left are the prediction and its correction, on the right the correction alone in the band of its
    covariance, with bars for the later estimates' own. Raises InputError where nothing was measured later.

    errors: as `corrected.errors_at_estimates` returns
    level: share of the errors that band and bars should hold
    """
    if errors.empty:
        raise InputError("ephemeris: expected an estimate of a later track to hold it against, got none")
    figure = page_figure(height_mm=144.0)
    panels = figure.subplots(3, 2, sharex=True)
    for (left, right), (axis, name) in zip(panels, _AXES.items(), strict=True):
        days, before, after = errors["duration"] / DAY, errors[f"before_{axis}"], errors[f"after_{axis}"]
        band, bar = (half_width(level) * errors[f"{sigma}_{axis}"] for sigma in ("sigma", "sigma_e"))
        left.plot(days, before, ls="", label="no correction", **_BEFORE)
        left.plot(days, after, ls="", **_AFTER)
        shown = {"color": RESIDUAL, "lw": 0.0, "label": f"its {100.0 * level:g} % interval"}
        right.fill_between(days, -band, band, alpha=0.18, **shown)
        own = {"ecolor": MUTED, "elinewidth": 0.6, "label": "that of the later estimate"}
        right.errorbar(days, after, bar, fmt="none", **own)
        right.plot(days, after, ls="", **_AFTER)
        inside = 100.0 * (after.abs() <= np.hypot(band, bar)).mean()
        right.set_title(f"{inside:.0f} % of errors inside both combined", fontsize=8.0, loc="left")
        left.set_ylabel(f"{name} error")
        for axes in (left, right):
            axes.axhline(0.0, color=MUTED, lw=0.7)
            axes.yaxis.set_major_formatter(FuncFormatter(metres))
    panels[0, 0].set_title("before and after the correction", fontsize=8.0, loc="left")
    figure.supxlabel(r"time since the estimate $\Delta t$ [d]", fontsize=8.0)
    figure.supylabel("ephemeris minus later estimate, RSW", fontsize=8.0)
    last = errors[errors["duration"] > errors["duration"].max() - DAY].abs()
    off, without = (metres(rounded(last[f"{when}_y"].median())) for when in ("after", "before"))
    headline = f"On the last day the ephemeris is {off} off along the track, uncorrected {without}"
    add_head_and_legend(figure, headline, f"{note}; {len(errors)} later estimates", columns=4)
    return figure
