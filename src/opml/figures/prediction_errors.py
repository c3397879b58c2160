"""Prediction errors against the prediction duration: what they are, and what a model leaves of them.

A prediction error is predicted minus true, in RSW of the true state: x radial, y along-track, z cross-track.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.axis_labels import axis, symbol, unit
from opml.figures.notes import SHORT_DAYS, Context, short
from opml.figures.style import (
    HIGHLIGHT,
    MUTED,
    PREDICTED,
    PUBLISHED,
    RESIDUAL,
    TRUE,
    column_figure,
    legend,
    noted,
    page_figure,
)
from opml.learning.judge import metrics

CLUSTER_DAYS = 0.25
"""Width of a cluster of durations [d]: four per day, wide enough for one station, narrow enough for three."""

CLUSTER_LEAST = 5
"""Points that a cluster needs for its mean and standard deviation to say something."""

REDUCED = 100.0
"""Individual metric p_ML [%] below which the correction made an error smaller."""

P_ML_MAX = 500.0
"""Individual metric p_ML [%] beyond which all points share one colour, as in the paper."""

DECADES = 4.5
"""Of sizes of errors that a logarithmic axis shows."""

BARS = "bars: mean and standard deviation in clusters of a quarter of a day"
"""What error bars are, as figures say it."""

SHADES = colormaps["viridis"](np.linspace(0.0, 0.8, 256))
"""Of p_ML: without the yellow that few can tell from the colour of what lies beyond."""

DURATION_LABEL = r"prediction duration $\Delta t$ [d]"


NO_CONTEXT = Context()


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


def distribution_position(pairs: pd.DataFrame, *, note: str = "") -> Figure:
    """Absolute position errors [km], logarithmic, against the duration [d]; one panel per component.

    `pairs`: rows of a `predictions` or `dataset` table; those without a prediction are left out. Raises
    InputError without a row to draw. After the paper's figure 'Distribution of the true prediction error'.
    """
    return _distribution(pairs, ("e_x", "e_y", "e_z"), note, absolute=True)


def distribution_velocity(pairs: pd.DataFrame, *, note: str = "") -> Figure:
    """Velocity errors [m/s] against the duration [d]; one panel per component.

    As `distribution_position`, but signed and on linear scales of their own: the radial component, which the
    along-track position error dictates, is a hundred times the others.
    """
    return _distribution(pairs, ("e_vx", "e_vy", "e_vz"), note, absolute=False)


def of_pairs(pairs: pd.DataFrame, *, rso: str, stations: str, days: Sequence[float], **_: object) -> str:
    """What the rows are that a distribution of errors shows, as its note."""
    first, last = days
    return (
        f"{rso} by {stations}, days {first:g} to {last:g}; {len(pairs)} predictions that the cleaning keeps; "
        "position and velocity: predicted less true, in RSW of the true state"
    )


def svr_absolute(
    evaluation: pd.DataFrame, *, component: str = "e_y", context: Context = NO_CONTEXT
) -> Figure:
    """Absolute errors against the duration: all points on the left, mean and spread of clusters on the right.

    `evaluation`: that table, of `component`. The true, predicted and residual errors have a panel each, on
    one logarithmic scale. The bars reach one standard deviation to either side of the mean, cut at zero; see
    `clusters`. Raises InputError without a row. After the paper's figures 'Results of the trained SVM model
    ...', panels 'Absolute value'.
    """
    return _points_and_bars(evaluation, component, context, absolute=True)


def svr_signed(evaluation: pd.DataFrame, *, component: str = "e_y", context: Context = NO_CONTEXT) -> Figure:
    """As `svr_absolute`, of the signed errors on linear scales: the paper's panels 'Real value'."""
    return _points_and_bars(evaluation, component, context, absolute=False)


def errorbar_absolute(
    evaluation: pd.DataFrame, *, component: str = "e_y", context: Context = NO_CONTEXT
) -> Figure:
    """Mean and spread of the absolute errors against the duration: `svr_absolute`'s right panel."""
    figure, axes = column_figure(height_mm=72.0)
    _draw_bars(axes, evaluation, component, context, absolute=True)
    legend(figure, columns=3, note=_lines(context.note, BARS))
    return figure


def rso_grid(
    evaluations: Mapping[str, pd.DataFrame],
    *,
    component: str = "e_y",
    contexts: Mapping[str, Context] | None = None,
) -> Figure:
    """`errorbar_absolute` of several RSOs side by side, two per row; the keys are the panels' titles.

    `contexts`: by RSO, what is said of each. Raises InputError without an RSO, or an RSO without a row. After
    the paper's figure 'Results of the ML approach applied on RSOs with different orbit altitude'.
    """
    if not evaluations:
        raise InputError("grid of RSOs: expected at least one evaluation, got none")
    rows = math.ceil(len(evaluations) / 2)
    figure = page_figure(height_mm=16.0 + 56.0 * rows)
    panels = figure.subplots(rows, 2, squeeze=False, sharex=True).ravel()
    for axes, (name, evaluation) in zip(panels, evaluations.items(), strict=False):
        _draw_bars(axes, evaluation, component, (contexts or {}).get(name, NO_CONTEXT), absolute=True)
        axes.set_title(name, fontsize=8.0, loc="left")
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels[len(evaluations) :]:
        axes.remove()
    notes = dict.fromkeys(one.note for one in (contexts or {}).values())
    legend(figure, columns=3, note=_lines(*notes, BARS))
    return figure


def individual_reduced(evaluation: pd.DataFrame, *, component: str = "e_y", note: str = "") -> Figure:
    """Points whose error the model made smaller: absolute true errors, and residuals coloured by p_ML [%].

    Raises InputError without a row; a model that reduces no error gives empty axes. After the paper's figure
    'Individual performance of the trained SVM model on future epochs'.
    """
    chosen = _individual_p_ml(evaluation) < REDUCED
    return _individual(evaluation, chosen, component, (0.0, REDUCED), ListedColormap(SHADES), "reduced", note)


def individual_increased(evaluation: pd.DataFrame, *, component: str = "e_y", note: str = "") -> Figure:
    """Points whose error the model made larger; else as `individual_reduced`.

    Beyond P_ML_MAX there is one colour.
    """
    chosen = _individual_p_ml(evaluation) > REDUCED
    colors = ListedColormap(SHADES).with_extremes(over=HIGHLIGHT)
    return _individual(evaluation, chosen, component, (REDUCED, P_ML_MAX), colors, "increased", note)


def individual_distribution(
    evaluation: pd.DataFrame, *, published: float | None = None, note: str = ""
) -> Figure:
    """Share of the points [%] whose p_ML is below p_ML,max, against p_ML,max [%].

    The dashed line marks the points whose error the model reduces; `published` is their share [%] in the
    paper. Raises InputError without a row. After the paper's figure 'Distribution of the individual metric
    p_ML'.
    """
    individual = np.sort(_individual_p_ml(_not_empty(evaluation)))
    limits = np.linspace(0.0, P_ML_MAX, 501)
    share = 100.0 * np.searchsorted(individual, limits, side="left") / len(individual)
    reduced = float(np.interp(REDUCED, limits, share))

    figure, axes = column_figure(height_mm=66.0)
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
    if published is not None:
        look: dict[str, Any] = {"ls": "", "marker": "D", "ms": 6.0, "mfc": "none", "mec": PUBLISHED}
        axes.plot([REDUCED], [published], label=f"Peng & Bai, about {published:g} %", **look)
        axes.legend(loc="lower right")
    noted(figure, note)
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


def _distribution(pairs: pd.DataFrame, components: tuple[str, ...], note: str, *, absolute: bool) -> Figure:
    pairs = _not_empty(pairs.dropna(subset=list(components)))
    days = (pairs["t_j"] - pairs["t_i"]).to_numpy() / DAY
    figure = page_figure(height_mm=66.0)
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
        _logarithmic(axes, pairs[list(components)].abs() * factor)
    noted(figure, note)
    return figure


def _points_and_bars(evaluation: pd.DataFrame, component: str, context: Context, *, absolute: bool) -> Figure:
    figure = page_figure(height_mm=76.0)
    *panels, right = figure.subplots(1, 1 + len(_CURVES), sharex=True, width_ratios=(1.0, 1.0, 1.0, 1.7))
    drawn = _drawn(evaluation, component, absolute=absolute)
    for axes, curve in zip(panels, _CURVES, strict=True):
        axes.sharey(panels[0])
        _draw_points(axes, drawn, curve)
        _draw_fences(axes, component, context, absolute=absolute)
        axes.tick_params(labelleft=axes is panels[0])
        axes.set_title(curve.label.format(axis=axis(component)), fontsize=8.0, loc="left")
    _label(panels[0], component, absolute=absolute)
    for axes in panels:
        axes.set_xlabel(DURATION_LABEL, fontsize=7.0)
    if absolute:
        _logarithmic(panels[0], drawn[[curve.column for curve in _CURVES]])
    _draw_bars(right, evaluation, component, context, absolute=absolute)
    points = "left: every prediction, lines through the medians; right: mean and standard deviation"
    note = _lines(context.note, f"{points} in clusters of a quarter of a day", _of_fences(component, context))
    legend(figure, columns=4, note=note, labels=dict(zip(*_shown(right), strict=True)))
    return figure


def _draw_points(axes: Axes, drawn: pd.DataFrame, curve: _Curve) -> None:
    """All points of one error, and a line through the medians of its clusters."""
    hollow = curve.column == "true"
    axes.scatter(
        drawn["duration"],
        drawn[curve.column],
        s=5.0 if hollow else 2.0,
        facecolors="none" if hollow else curve.color,
        edgecolors=curve.color if hollow else "none",
        linewidths=0.3 if hollow else 0.0,
        alpha=float(np.clip(3000.0 / len(drawn), 0.25, 1.0)),
        rasterized=True,
    )
    place = np.ceil(drawn["duration"] / CLUSTER_DAYS)
    middle = drawn[["duration", curve.column]].groupby(place).median()
    axes.plot(middle["duration"], middle[curve.column], color="white", lw=2.6, zorder=3.0)
    axes.plot(middle["duration"], middle[curve.column], color=curve.color, lw=1.2, zorder=3.1)


def _logarithmic(axes: Axes, sizes: pd.DataFrame) -> None:
    """A logarithmic axis for sizes of errors, DECADES from the largest down; what is less is not shown."""
    axes.set_yscale("log")
    most = float(np.nanmax(sizes.to_numpy(), initial=0.0)) or 1.0
    axes.set_ylim(most * 10.0**-DECADES, 1.6 * most)


def _draw_fences(axes: Axes, component: str, context: Context, *, absolute: bool) -> None:
    """Where the cleaning ends the true errors: no tested row lies beyond."""
    if context.fences is None:
        return
    _, factor = unit(component)
    low, high = context.fences
    for value in {max(-low, high)} if absolute else {low, high}:
        axes.axhline(value * factor, color=HIGHLIGHT, ls="--", lw=1.0, zorder=2.5)


def _of_fences(component: str, context: Context) -> str:
    """Of the line of the fences, what it is."""
    if context.fences is None:
        return ""
    name, factor = unit(component)
    low, high = (value * factor for value in context.fences)
    where = f"{low:.1f} and {high:.1f} {name}"
    return f"dashed: Tukey's fences of the cleaning at {where}, which end the true errors"


def _shown(axes: Axes) -> tuple[list[str], list[Artist]]:
    handles, labels = axes.get_legend_handles_labels()
    return labels, handles


def _lines(*parts: str) -> str:
    """The parts that say something, a line each."""
    return "\n".join(filter(None, parts))


def _draw_bars(
    axes: Axes, evaluation: pd.DataFrame, component: str, context: Context, *, absolute: bool
) -> None:
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
    axes.text(
        0.03,
        0.97,
        _p_ml(evaluation, context),
        transform=axes.transAxes,
        va="top",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5},
        zorder=4.0,
    )
    axes.set_title(_counted(evaluation, component, context), fontsize=6.5, color=PUBLISHED, loc="right")
    _label(axes, component, absolute=absolute)


def _p_ml(evaluation: pd.DataFrame, context: Context) -> str:
    p_ml = metrics.p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())
    low, high = context.interval or (math.nan, math.nan)
    interval = f" ({low:.1f} to {high:.1f} %)" if context.interval else ""
    return rf"$P_{{\mathrm{{ML}}}}$ = {p_ml:.1f} %" + interval


def _counted(evaluation: pd.DataFrame, component: str, context: Context) -> str:
    """How many predictions there are, and what a linear axis does not show of the short ones."""
    rows = f"{len(evaluation)} predictions of {evaluation['i'].nunique()} estimates"
    kept = "" if context.kept is None else f"; {context.kept:.3g} % of the pairs are kept"
    before, after = short(evaluation)
    if math.isnan(before):
        return rows + kept
    name = "m/s" if unit(component)[0] == "m/s" else "m"
    sizes = f"{_figures(before)} {name}, corrected {_figures(after)} {name}"
    return f"{rows}{kept}\nmean size up to {SHORT_DAYS:g} d: {sizes}"


def _figures(value: float) -> str:
    """A number with three figures, or without decimals."""
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def _individual(
    evaluation: pd.DataFrame,
    chosen: np.ndarray,
    component: str,
    limits: tuple[float, float],
    colors: Colormap,
    verb: str,
    note: str,
) -> Figure:
    drawn = _drawn(evaluation, component, absolute=True)
    figure, axes = column_figure(height_mm=80.0)
    axes.scatter(
        drawn["duration"][chosen],
        drawn["true"][chosen],
        s=6.0,
        facecolors="none",
        edgecolors=TRUE,
        linewidths=0.35,
        alpha=float(np.clip(1000.0 / max(1, chosen.sum()), 0.25, 1.0)),
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
    _logarithmic(axes, drawn.loc[chosen, ["true", "residual"]])
    made = legend(figure, columns=2, note=note)
    for handle in made.legend_handles:
        if isinstance(handle, PathCollection):
            handle.set_sizes([12.0])
            if handle.get_array() is not None:
                handle.set(array=None, facecolor=colors(0.5))
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
