"""One object as an operator sees it: predicted, corrected, and measured later."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.style import MUTED, RESIDUAL, TRUE, legend, page_figure
from opml.orbits.rsw_covariance import half_width

_AXES = {"x": "radial", "y": "along-track", "z": "cross-track"}
_METRES = 1e-3  # in kilometres


def later_errors(errors: pd.DataFrame, *, level: float, note: str = "") -> Figure:
    """Errors of one ephemeris against estimates of later tracks, by duration [d]; one row per axis of RSW.

    errors: as `corrected.held_against` returns. On the left the prediction and its correction [km], on the
    right the correction alone [m], with the band that its covariance gives to the `level`; `note`: whose
    they are. Raises InputError where nothing was measured later.
    """
    if errors.empty:
        raise InputError("ephemeris: expected an estimate of a later track to hold it against, got none")
    figure = page_figure(height_mm=144.0)
    panels = figure.subplots(3, 2, sharex=True)
    for (left, right), (axis, name) in zip(panels, _AXES.items(), strict=True):
        _draw(left, errors, f"before_{axis}", _METRES, color=TRUE, marker="o", label="no correction")
        _draw(left, errors, f"after_{axis}", _METRES, color=RESIDUAL, marker="^", label="corrected")
        _draw_band(right, errors, axis, level)
        _draw(right, errors, f"after_{axis}", 1.0, color=RESIDUAL, marker="^", label="corrected")
        left.set_ylabel(f"{name} [km]")
        right.set_ylabel(f"{name} [m]")
    figure.supxlabel(r"time since the estimate $\Delta t$ [d]", fontsize=8.0)
    figure.supylabel("predicted less later estimate, in RSW of the estimate", fontsize=8.0)
    legend(figure, columns=3, note=note)
    return figure


def _draw(
    axes: Axes, errors: pd.DataFrame, column: str, scale: float, *, color: str, marker: str, label: str
) -> None:
    """Errors, a point for each later estimate."""
    axes.axhline(0.0, color=MUTED, lw=0.7)
    axes.plot(
        errors["duration"] / DAY,
        scale * errors[column],
        color=color,
        marker=marker,
        ms=2.6,
        lw=0.5,
        label=label,
    )


def _draw_band(axes: Axes, errors: pd.DataFrame, axis: str, level: float) -> None:
    """The interval about the correction that its covariance gives."""
    half = half_width(level) * errors[f"sigma_{axis}"]
    days, label = errors["duration"] / DAY, f"{100.0 * level:g} % by its covariance"
    axes.fill_between(days, -half, half, color=RESIDUAL, alpha=0.18, lw=0.0, label=label)
