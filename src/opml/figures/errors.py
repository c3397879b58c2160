"""Prediction errors against the prediction duration: what they are, and what a model leaves of them.

A prediction error is predicted minus true, in RSW of the true state: x radial, y along-track, z cross-track.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap
from matplotlib.figure import Figure

from opml.constants import DAY
from opml.errors import InputError
from opml.figures.labels import axis, symbol, unit
from opml.figures.style import HIGHLIGHT, MUTED, PREDICTED, RESIDUAL, TRUE, column_figure, page_figure
from opml.learning import metrics

CLUSTER_DAYS = 0.25
"""Width of a cluster of durations [d]: four per day, wide enough for one station, narrow enough for three."""

CLUSTER_LEAST = 5
"""Points that a cluster needs for its mean and standard deviation to say something."""

REDUCED = 100.0
"""Individual metric p_ML [%] below which the correction made an error smaller."""

P_ML_MAX = 500.0
"""Individual metric p_ML [%] beyond which all points share one colour, as in the paper."""

DURATION_LABEL = r"prediction duration $\Delta t$ [d]"


@dataclass(frozen=True)
class _Curve:
    """One of the three errors of an `evaluation`, and its look."""

    column: str
    label: str
    color: str
    marker: str
    shift: float  # of its error bars along the duration, in widths of a cluster


_CURVES = (
    _Curve("true", "true $e_{{{axis}}}$", TRUE, "o", -0.22),
    _Curve("predicted", r"ML-predicted $\hat{{e}}_{{\mathrm{{ML}},{axis}}}$", PREDICTED, "s", 0.0),
    _Curve("residual", r"residual $e_{{\mathrm{{res}}}}$", RESIDUAL, "^", 0.22),
)


def distribution_position(pairs: pd.DataFrame) -> Figure:
    """Absolute position errors [km], logarithmic, against the duration [d]; one panel per component.

    `pairs`: rows of a `predictions` or `dataset` table; those without a prediction are left out. Raises
    InputError without a row to draw. After the paper's figure 'Distribution of the true prediction error'.
    """
    return _distribution(pairs, ("e_x", "e_y", "e_z"), absolute=True)


def distribution_velocity(pairs: pd.DataFrame) -> Figure:
    """Velocity errors [m/s] against the duration [d]; one panel per component.

    As `distribution_position`, but signed and on linear scales of their own: the radial component, which the
    along-track position error dictates, is a hundred times the others.
    """
    return _distribution(pairs, ("e_vx", "e_vy", "e_vz"), absolute=False)


def svr_absolute(evaluation: pd.DataFrame, *, component: str = "e_y") -> Figure:
    """Absolute errors against the duration: all points on the left, mean and spread of clusters on the right.

    `evaluation`: that table, of `component`. The bars reach one standard deviation to either side of the
    mean, cut at zero; see `clusters`. Raises InputError without a row. After the paper's figures 'Results of
    the trained SVM model ...', panels 'Absolute value'.
    """
    return _points_and_bars(evaluation, component, absolute=True)


def svr_signed(evaluation: pd.DataFrame, *, component: str = "e_y") -> Figure:
    """As `svr_absolute`, of the signed errors: the paper's panels 'Real value'."""
    return _points_and_bars(evaluation, component, absolute=False)


def errorbar_absolute(evaluation: pd.DataFrame, *, component: str = "e_y") -> Figure:
    """Mean and spread of the absolute errors against the duration: `svr_absolute`'s right panel."""
    figure, axes = column_figure(height_mm=64.0)
    _draw_bars(axes, evaluation, component, absolute=True)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3, columnspacing=1.0)
    return figure


def rso_grid(evaluations: Mapping[str, pd.DataFrame], *, component: str = "e_y") -> Figure:
    """`errorbar_absolute` of several RSOs side by side, two per row; the keys are the panels' titles.

    Raises InputError without an RSO, or an RSO without a row. After the paper's figure 'Results of the ML
    approach applied on RSOs with different orbit altitude'.
    """
    if not evaluations:
        raise InputError("grid of RSOs: expected at least one evaluation, got none")
    rows = math.ceil(len(evaluations) / 2)
    figure = page_figure(height_mm=10.0 + 54.0 * rows)
    panels = figure.subplots(rows, 2, squeeze=False, sharex=True).ravel()
    for axes, (name, evaluation) in zip(panels, evaluations.items(), strict=False):
        _draw_bars(axes, evaluation, component, absolute=True)
        axes.set_title(name, fontsize=8.0, loc="left")
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels[len(evaluations) :]:
        axes.remove()
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def individual_reduced(evaluation: pd.DataFrame, *, component: str = "e_y") -> Figure:
    """Points whose error the model made smaller: absolute true errors, and residuals coloured by p_ML [%].

    Raises InputError without a row; a model that reduces no error gives empty axes. After the paper's figure
    'Individual performance of the trained SVM model on future epochs'.
    """
    chosen = _individual_p_ml(evaluation) < REDUCED
    return _individual(evaluation, chosen, component, (0.0, REDUCED), colormaps["viridis"], "reduced")


def individual_increased(evaluation: pd.DataFrame, *, component: str = "e_y") -> Figure:
    """Points whose error the model made larger; else as `individual_reduced`.

    Beyond P_ML_MAX there is one colour.
    """
    chosen = _individual_p_ml(evaluation) > REDUCED
    colors = colormaps["viridis"].with_extremes(over=HIGHLIGHT)
    return _individual(evaluation, chosen, component, (REDUCED, P_ML_MAX), colors, "increased")


def individual_distribution(evaluation: pd.DataFrame) -> Figure:
    """Share of the points [%] whose p_ML is below p_ML,max, against p_ML,max [%].

    The dashed line marks the points whose error the model reduces. Raises InputError without a row. After
    the paper's figure 'Distribution of the individual metric p_ML'.
    """
    individual = np.sort(_individual_p_ml(_not_empty(evaluation)))
    limits = np.linspace(0.0, P_ML_MAX, 501)
    share = 100.0 * np.searchsorted(individual, limits, side="left") / len(individual)
    reduced = float(np.interp(REDUCED, limits, share))

    figure, axes = column_figure(height_mm=60.0)
    axes.plot(limits, share, color=RESIDUAL)
    axes.axvline(REDUCED, color=MUTED, ls="--", lw=1.0, zorder=1)
    axes.plot([REDUCED], [reduced], "o", color=RESIDUAL)
    axes.annotate(
        f"{reduced:.1f} % of the points\nbelow {REDUCED:.0f} %",
        (REDUCED, reduced),
        xytext=(8.0, -8.0),
        textcoords="offset points",
        va="top",
    )
    axes.set_xlabel(r"$p_{\mathrm{ML,max}}$ [%]")
    axes.set_ylabel(r"points with $p_{\mathrm{ML}} < p_{\mathrm{ML,max}}$ [%]")
    axes.set_xlim(0.0, P_ML_MAX)
    axes.set_ylim(0.0, 100.0)
    return figure


def clusters(duration: np.ndarray, values: np.ndarray) -> pd.DataFrame:
    """Mean duration [d], mean value and standard deviation of the values in each cluster of durations [d].

    Clusters are windows of CLUSTER_DAYS, half open like (0, 0.25]; those with fewer than CLUSTER_LEAST
    points are left out. The standard deviation is the sample's (n - 1).
    """
    points = pd.DataFrame({"duration": duration, "value": values})
    grouped = points.groupby(np.ceil(duration / CLUSTER_DAYS))
    table = pd.DataFrame(
        {
            "duration": grouped["duration"].mean(),
            "mean": grouped["value"].mean(),
            "std": grouped["value"].std(),
        }
    )
    return table[grouped.size() >= CLUSTER_LEAST].reset_index(drop=True)


def _distribution(pairs: pd.DataFrame, components: tuple[str, ...], *, absolute: bool) -> Figure:
    pairs = _not_empty(pairs.dropna(subset=list(components)))
    days = (pairs["t_j"] - pairs["t_i"]).to_numpy() / DAY
    figure = page_figure(height_mm=62.0)
    for axes, component in zip(figure.subplots(1, 3, sharex=True, sharey=absolute), components, strict=True):
        unit_name, factor = unit(component)
        values = pairs[component].to_numpy() * factor
        axes.scatter(
            days,
            np.abs(values) if absolute else values,
            s=1.2,
            color=TRUE,
            alpha=float(np.clip(3000.0 / len(pairs), 0.15, 0.5)),  # the fainter, the more there are
            linewidths=0.0,
            rasterized=True,
        )
        axes.set_xlabel(DURATION_LABEL)
        name = axis(component)
        axes.set_ylabel(
            rf"$|e_{{{name}}}|$ [{unit_name}]" if absolute else f"{symbol(component)} [{unit_name}]"
        )
        axes.yaxis.set_tick_params(labelleft=True)
        axes.set_xlim(left=0.0)
    if absolute:
        axes.set_yscale("log")
    return figure


def _points_and_bars(evaluation: pd.DataFrame, component: str, *, absolute: bool) -> Figure:
    figure = page_figure(height_mm=70.0)
    left, right = figure.subplots(1, 2, sharex=True)
    drawn = _drawn(evaluation, component, absolute=absolute)
    for order, curve in enumerate(_CURVES):
        hollow = curve.column == "true"
        left.scatter(
            drawn["duration"],
            drawn[curve.column],
            s=7.0 if hollow else 2.0,
            facecolors="none" if hollow else curve.color,
            edgecolors=curve.color if hollow else "none",
            linewidths=0.4 if hollow else 0.0,
            zorder=2.0 + 0.1 * order,
            rasterized=True,
        )
    _label(left, component, absolute=absolute)
    _draw_bars(right, evaluation, component, absolute=absolute)
    figure.legend(*right.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def _draw_bars(axes: Axes, evaluation: pd.DataFrame, component: str, *, absolute: bool) -> None:
    """Error bars of the three errors, slightly displaced, with P_ML and how much it is measured on."""
    drawn = _drawn(evaluation, component, absolute=absolute)
    for order, curve in enumerate(_CURVES):
        table = clusters(drawn["duration"].to_numpy(), drawn[curve.column].to_numpy())
        axes.errorbar(
            table["duration"] + curve.shift * CLUSTER_DAYS,
            table["mean"],
            yerr=table["std"],
            color=curve.color,
            marker=curve.marker,
            markersize=2.2,
            linewidth=0.8,
            elinewidth=0.7,
            zorder=2.0 + 0.1 * order,
            label=curve.label.format(axis=axis(component)),
        )
    p_ml = metrics.p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())
    axes.text(
        0.03,
        0.97,
        rf"$P_{{\mathrm{{ML}}}}$ = {p_ml:.1f} %",
        transform=axes.transAxes,
        va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5},
        zorder=4.0,
    )
    counted = f"{len(evaluation)} predictions of {evaluation['i'].nunique()} estimates"
    axes.set_title(counted, fontsize=7.0, color=MUTED, loc="right")
    _label(axes, component, absolute=absolute)


def _individual(
    evaluation: pd.DataFrame,
    chosen: np.ndarray,
    component: str,
    limits: tuple[float, float],
    colors: Colormap,
    verb: str,
) -> Figure:
    drawn = _drawn(evaluation, component, absolute=True)
    figure, axes = column_figure(height_mm=74.0)
    axes.scatter(
        drawn["duration"][chosen],
        drawn["true"][chosen],
        s=6.0,
        facecolors="none",
        edgecolors=TRUE,
        linewidths=0.35,
        rasterized=True,
        label=rf"true $e_{{{axis(component)}}}$",
    )
    points = axes.scatter(
        drawn["duration"][chosen],
        drawn["residual"][chosen],
        c=np.minimum(_individual_p_ml(evaluation)[chosen], 2.0 * P_ML_MAX),  # infinity has no colour
        cmap=colors,
        vmin=limits[0],
        vmax=limits[1],
        s=3.0,
        linewidths=0.0,
        rasterized=True,
        label=r"residual $e_{\mathrm{res}}$, coloured by $p_{\mathrm{ML}}$",
    )
    beyond = "max" if limits[1] > REDUCED else "neither"
    bar = figure.colorbar(points, ax=axes, extend=beyond, pad=0.02, ticks=np.linspace(*limits, 5))
    bar.set_label(r"$p_{\mathrm{ML}}$ [%]")
    bar.outline.set_linewidth(0.5)
    axes.set_title(f"{verb}: {chosen.sum()} of {len(chosen)} points", fontsize=8.0, loc="left")
    _label(axes, component, absolute=True)
    legend = figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    handles = [handle for handle in legend.legend_handles if isinstance(handle, PathCollection)]
    handles[1].set(array=None, facecolor=colors(0.5))
    for handle in handles:
        handle.set_sizes([12.0])
    return figure


def _label(axes: Axes, component: str, *, absolute: bool) -> None:
    unit_name, _ = unit(component)
    quantity = "absolute error" if absolute else "error"
    axes.set_xlabel(DURATION_LABEL)
    axes.set_ylabel(f"{quantity} of {symbol(component)} [{unit_name}]")
    axes.set_xlim(left=0.0)
    if absolute:
        axes.set_ylim(bottom=0.0)


def _drawn(evaluation: pd.DataFrame, component: str, *, absolute: bool) -> pd.DataFrame:
    """Duration [d] and the three errors in the unit they are drawn in."""
    evaluation = _not_empty(evaluation)
    _, factor = unit(component)
    errors = evaluation[[curve.column for curve in _CURVES]] * factor
    return (errors.abs() if absolute else errors).assign(duration=evaluation["duration"] / DAY)


def _not_empty(table: pd.DataFrame) -> pd.DataFrame:
    if table.empty:
        raise InputError("figure of errors: expected at least one row, got none")
    return table


def _individual_p_ml(evaluation: pd.DataFrame) -> np.ndarray:
    return metrics.individual_p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())
