"""Figures of prediction errors against the prediction duration, before and after a model corrects them.

A prediction error is predicted minus true, in RSW of the true state: x radial, y along-track, z cross-track.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.axis_labels import (
    DIRECTIONS,
    PAPER,
    axis,
    clauses,
    in_words,
    lines,
    size_label,
    symbol,
    unit,
)
from opml.figures.display_names import display_rso
from opml.figures.notes import Context, constant_note, counts_note, fences_note, p_ml_note
from opml.figures.style import (
    HIGHLIGHT,
    MUTED,
    PREDICTED_COLOR,
    PUBLISHED,
    RESIDUAL,
    TRUE_COLOR,
    add_head,
    add_head_and_legend,
    column_figure,
    page_figure,
    panel_figure,
)
from opml.learning.judge import metrics

CLUSTER_DAYS = 0.25
"""Width of a cluster of durations [d]: four per day, wide enough for one station, narrow enough for three."""

CLUSTER_LEAST = 5  # points that a cluster needs for its mean and standard deviation to say something
REDUCED = 100.0  # individual metric p_ML [%] below which the correction made an error smaller
BEYOND_COLOR = PREDICTED_COLOR  # colour of the points beyond P_ML_MAX
P_ML_MAX = 500.0  # individual metric p_ML [%] beyond which all points share one colour, as in the paper
DECADES = 4.5  # powers of ten of the sizes of errors that a logarithmic axis shows
HEADROOM = 0.16  # room above error bars that their P_ML stands in, in parts of the axis

LINES_OF_COUNTS = "\n\n"
"""Height of an RSO's name above the counts on the right of its panel, which may be as long as the panel."""

BARS = "bars: mean and standard deviation by quarter of a day"  # note on error bars

SHADES = colormaps["viridis"](np.linspace(0.0, 0.8, 256))
WORSE_SHADES = colormaps["OrRd"](np.linspace(0.35, 1.0, 256))
"""Colours of p_ML below and above 100 %."""

WHOLE_DAYS = 3.0  # reach of a duration [d] from which on its axis has a tick each day

DURATION_LABEL = r"prediction duration $\Delta t$ [d]"

NO_CONTEXT = Context()


@dataclass(frozen=True)
class _Curve:
    """The look of one of the three errors of an `evaluation`."""

    column: str
    label: str
    color: str
    marker: str
    shift: float  # of its error bars along the duration, in widths of a cluster


_CURVES = (
    _Curve("true", "true $e_{{{axis}}}$", TRUE_COLOR, "o", -0.22),
    _Curve("predicted", r"ML-predicted $\hat{{e}}_{{\mathrm{{ML}},{axis}}}$", PREDICTED_COLOR, "s", 0.0),
    _Curve("residual", r"residual $e_{{\mathrm{{res}}}}$", RESIDUAL, "^", 0.22),
)


def distribution_position(pairs: pd.DataFrame, *, note: str = "") -> Figure:
    """Draw absolute position errors [km], logarithmic, against the duration [d]; one panel per component.

    After the paper's figure 'Distribution of the true prediction error'. Raises InputError without a row to
    draw.

    pairs: rows of a `predictions` or `dataset` table; pairs without a prediction are left out
    """
    return _distribution(pairs, ("e_x", "e_y", "e_z"), note, absolute=True)


def distribution_velocity(pairs: pd.DataFrame, *, note: str = "") -> Figure:
    """Draw velocity errors [m/s] against the duration [d]; one panel per component.

    As `distribution_position`, but signed and on linear scales of their own: the radial component, which the
    along-track position error dictates, is a hundred times the others.
    """
    scales = "each panel has its own scale"
    return _distribution(pairs, ("e_vx", "e_vy", "e_vz"), clauses(note, scales), absolute=False)


def pairs_note(pairs: pd.DataFrame, run: str, days: Sequence[float]) -> str:
    """Return the note of a distribution of errors: the rows that it shows, of a run in words, by days."""
    first, last = days
    return (
        f"{run}, days {first:g} to {last:g}; {len(pairs)} predictions that the cleaning "
        "keeps; position and velocity: predicted less true, in RSW of the true state"
    )


def svr_absolute(
    evaluation: pd.DataFrame, *, component: str = "e_y", context: Context = NO_CONTEXT
) -> Figure:
    """Draw absolute errors against the duration: points on the left, clusters' mean and spread on the right.

    The true, predicted and residual errors have a panel each, on one logarithmic scale. The bars reach one
    standard deviation to either side of the mean, cut at zero; see `clusters`. After the paper's figures
    'Results of the trained SVM model ...', panels 'Absolute value'. Raises InputError without a row.

    context: what the figure has besides the errors
    """
    return _points_and_bars(evaluation, component, context, absolute=True)


def svr_signed(evaluation: pd.DataFrame, *, component: str = "e_y", context: Context = NO_CONTEXT) -> Figure:
    """Draw signed errors on linear scales, else as `svr_absolute`: the paper's panels 'Real value'."""
    return _points_and_bars(evaluation, component, context, absolute=False)


def errorbar_absolute(
    evaluation: pd.DataFrame, *, component: str = "e_y", context: Context = NO_CONTEXT
) -> Figure:
    """Draw mean and spread of the absolute errors against the duration: `svr_absolute`'s right panel."""
    figure, axes = column_figure(height_mm=76.0)
    _draw_bars(axes, evaluation, component, context, absolute=True)
    headline = f"{_p_ml(evaluation):.0f} % of the error remains"
    add_head_and_legend(figure, headline, lines(context.note, BARS), columns=3)
    return figure


def rso_grid(
    evaluations: Mapping[str, pd.DataFrame],
    *,
    component: str = "e_y",
    contexts: Mapping[str, Context] | None = None,
) -> Figure:
    """Draw `errorbar_absolute` of several RSOs side by side, two per row.

    After the paper's figure 'Results of the ML approach applied on RSOs with different orbit altitude'.
    Raises InputError without an RSO, or for an RSO without a row.

    evaluations: those tables, by RSO, the panel's title
    contexts: what each panel has besides the errors, by RSO
    """
    if not evaluations:
        raise InputError("grid of RSOs: expected at least one evaluation, got none")
    contexts = contexts or {}
    names = {f"{display_rso(rso)}{LINES_OF_COUNTS}": rso for rso in evaluations}

    def draw(axes: Axes, title: str) -> None:
        rso = names[title]
        _draw_bars(axes, evaluations[rso], component, contexts.get(rso, NO_CONTEXT), absolute=True)

    figure = panel_figure(list(names), draw, columns=2, heights_mm=(16.0, 56.0), share_y=False)
    notes = dict.fromkeys(context.note for context in contexts.values())
    ranked = sorted((_p_ml(evaluation), display_rso(rso)) for rso, evaluation in evaluations.items())
    (least, best), (most, worst) = ranked[0], ranked[-1]
    headline = f"{least:.0f} % ({best}) to {most:.0f} % ({worst}) of the error remains"
    note = lines(*notes, f"{BARS}; each panel has its own scale")
    add_head_and_legend(figure, headline, note, columns=3)
    return figure


def individual_reduced(evaluation: pd.DataFrame, *, component: str = "e_y", note: str = "") -> Figure:
    """Draw predictions whose error got smaller: absolute true errors, and residuals coloured by p_ML [%].

    After the paper's figure 'Individual performance of the trained SVM model on future epochs'. Raises
    InputError without a row; a model that reduces no error gives empty axes.
    """
    change = _Change("reduced", (0.0, REDUCED), ListedColormap(SHADES))
    return _individual(evaluation, _individual_p_ml(evaluation) < REDUCED, change, component, note)


def individual_increased(evaluation: pd.DataFrame, *, component: str = "e_y", note: str = "") -> Figure:
    """Draw predictions whose error got larger, else as `individual_reduced`; colours end at P_ML_MAX."""
    colors = ListedColormap(WORSE_SHADES).with_extremes(over=BEYOND_COLOR)
    change = _Change("increased", (REDUCED, P_ML_MAX), colors)
    return _individual(evaluation, _individual_p_ml(evaluation) > REDUCED, change, component, note)


def individual_distribution(
    evaluation: pd.DataFrame, *, published: float | None = None, note: str = ""
) -> Figure:
    """Draw the share of the predictions [%] whose p_ML is below p_ML,max, against p_ML,max [%].

    After the paper's figure 'Distribution of the individual metric p_ML'. The dashed line ends the
    predictions whose error the model reduces. Raises InputError without a row.

    published: share of the reduced errors in the paper [%]
    """
    _check_rows(evaluation)
    individual = np.sort(_individual_p_ml(evaluation))
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
        axes.plot([REDUCED], [published], label=f"{PAPER}, about {published:g} %", **look)
        axes.legend(loc="lower right")
    headline = f"{reduced:.1f} % of the errors are reduced"
    add_head(figure, headline, clauses(note, f"{len(individual)} predictions"))
    axes.set_xlabel(r"$p_{\mathrm{ML,max}}$ [%]")
    axes.set_ylabel(r"points with $p_{\mathrm{ML}} < p_{\mathrm{ML,max}}$ [%]")
    axes.set_xlim(0.0, P_ML_MAX)
    axes.set_ylim(0.0, 100.0)
    return figure


def clusters(duration: np.ndarray, values: np.ndarray) -> pd.DataFrame:
    """Return duration, mean and std, one row per cluster of durations.

    Clusters are windows of CLUSTER_DAYS, half open like (0, 0.25]; clusters of fewer than CLUSTER_LEAST
    points are left out. The standard deviation is the sample's (n - 1).

    duration: (n,) [d], of which the table has the mean
    values: (n,)
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
    pairs = pairs.dropna(subset=list(components))
    _check_rows(pairs)
    days = (pairs["t_j"] - pairs["t_i"]).to_numpy() / DAY
    figure = page_figure(height_mm=76.0)
    for axes, component in zip(figure.subplots(1, 3, sharex=True, sharey=absolute), components, strict=True):
        _, factor = unit(component)
        values = pairs[component].to_numpy() * factor
        axes.scatter(
            days,
            np.abs(values) if absolute else values,
            s=1.2,
            color=TRUE_COLOR,
            alpha=float(np.clip(3000.0 / len(pairs), 0.15, 0.5)),  # the fainter, the more there are
            linewidths=0.0,
            rasterized=True,
        )
        _label(axes, component, absolute=absolute)
        axes.yaxis.set_tick_params(labelleft=True)
    below = _set_decades(axes, pairs[list(components)].abs() * factor) if absolute else ""
    medians = pairs[list(components)].abs().median() * factor
    sizes = (f"{DIRECTIONS[axis(one)[-1]]} {size:.3g}" for one, size in medians.items())
    what = "errors" if absolute else "velocity errors"
    add_head(figure, f"Median {what} [{unit(component)[0]}]: {', '.join(sizes)}", clauses(note, below))
    return figure


def _points_and_bars(evaluation: pd.DataFrame, component: str, context: Context, *, absolute: bool) -> Figure:
    figure = page_figure(height_mm=86.0)
    *panels, right = figure.subplots(1, 1 + len(_CURVES), sharex=True, width_ratios=(1.0, 1.0, 1.0, 1.7))
    errors = _drawn_errors(evaluation, component, absolute=absolute)
    for axes, curve in zip(panels, _CURVES, strict=True):
        axes.sharey(panels[0])
        _draw_points(axes, errors, curve)
        _draw_fences(axes, component, context, absolute=absolute)
        axes.tick_params(labelleft=axes is panels[0])
        axes.set_title(curve.label.format(axis=axis(component)), fontsize=8.0, loc="left")
    _label(panels[0], component, absolute=absolute)
    for axes in panels:
        axes.set_xlabel(DURATION_LABEL, fontsize=7.0)
    below = _set_decades(panels[0], errors[[curve.column for curve in _CURVES]]) if absolute else ""
    _draw_bars(right, evaluation, component, context, absolute=absolute)
    points = "left: every prediction, lines through the medians; right: mean and standard deviation"
    note = clauses(
        context.note,
        f"{points} in clusters of a quarter of a day",
        fences_note(component, context),
        constant_note(evaluation, component),
        below,
    )
    headline = f"Corrected {in_words(component)}s are {_p_ml(evaluation):.0f} % of the uncorrected"
    add_head_and_legend(figure, headline, note, columns=4)
    return figure


def _draw_points(axes: Axes, errors: pd.DataFrame, curve: _Curve) -> None:
    """Draw all points of one error, and a line through the medians of its clusters."""
    hollow = curve.column == "true"
    axes.scatter(
        errors["duration"],
        errors[curve.column],
        s=5.0 if hollow else 2.0,
        facecolors="none" if hollow else curve.color,
        edgecolors=curve.color if hollow else "none",
        linewidths=0.3 if hollow else 0.0,
        alpha=float(np.clip(3000.0 / len(errors), 0.25, 1.0)),
        rasterized=True,
    )
    place = np.ceil(errors["duration"] / CLUSTER_DAYS)
    middle = errors[["duration", curve.column]].groupby(place).median()
    line = _break_gaps(middle["duration"].to_numpy(), middle[curve.column].to_numpy())
    axes.plot(*line, color="white", lw=2.6, zorder=3.0)
    axes.plot(*line, color=curve.color, lw=1.2, zorder=3.1)


def _break_gaps(duration: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a line through clusters (n,) with a gap where a cluster between two has no points."""
    places = np.ceil(duration / CLUSTER_DAYS)
    gaps = np.flatnonzero(np.diff(places) > 1.0) + 1
    return np.insert(duration, gaps, np.nan), np.insert(values, gaps, np.nan)


def _set_decades(axes: Axes, sizes: pd.DataFrame) -> str:
    """Make the axis of sizes logarithmic, DECADES from the largest down; return how many are smaller."""
    axes.set_yscale("log")
    most = float(np.nanmax(sizes.to_numpy(), initial=0.0)) or 1.0
    least = most * 10.0**-DECADES
    axes.set_ylim(least, 1.6 * most)
    below = int((sizes < least).to_numpy().sum())
    return f"{below} {'point lies' if below == 1 else 'points lie'} below the axis" if below else ""


def _draw_fences(axes: Axes, component: str, context: Context, *, absolute: bool) -> None:
    """Draw where the cleaning ends the true errors: no tested row lies beyond."""
    if context.fences is None:
        return
    _, factor = unit(component)
    low, high = context.fences
    for value in {max(-low, high)} if absolute else {low, high}:
        axes.axhline(value * factor, color=HIGHLIGHT, ls="--", lw=1.0, zorder=2.5)


def _draw_bars(
    axes: Axes, evaluation: pd.DataFrame, component: str, context: Context, *, absolute: bool
) -> None:
    """Draw error bars of the three errors, slightly displaced, with P_ML and how much it is measured on."""
    errors = _drawn_errors(evaluation, component, absolute=absolute)
    for order, curve in enumerate(_CURVES):
        table = clusters(errors["duration"].to_numpy(), errors[curve.column].to_numpy())
        shift, zorder = curve.shift * CLUSTER_DAYS, 2.0 + 0.1 * order
        axes.errorbar(
            table["duration"] + shift,
            table["mean"],
            yerr=table["std"],
            color=curve.color,
            marker=curve.marker,
            markersize=2.2,
            linestyle="",
            elinewidth=0.7,
            zorder=zorder,
            label=curve.label.format(axis=axis(component)),
        )
        duration, mean = _break_gaps(table["duration"].to_numpy(), table["mean"].to_numpy())
        axes.plot(duration + shift, mean, color=curve.color, lw=0.8, zorder=zorder)
    axes.set_title(counts_note(evaluation, component, context), fontsize=6.5, color=PUBLISHED, loc="right")
    _label(axes, component, absolute=absolute)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + HEADROOM * (high - low))
    axes.text(0.02, 0.98, p_ml_note(evaluation, context), transform=axes.transAxes, va="top", size=7.5)


@dataclass(frozen=True)
class _Change:
    """Style of the errors that a model changed in one direction."""

    name: str
    limits: tuple[float, float]  # of the p_ML [%] that the colours distinguish
    colors: Colormap


def _individual(
    evaluation: pd.DataFrame, is_drawn: np.ndarray, change: _Change, component: str, note: str
) -> Figure:
    """Draw the predictions of an evaluation that are to be drawn; is_drawn: (n,)."""
    errors = _drawn_errors(evaluation, component, absolute=True)[is_drawn]
    figure, axes = column_figure(height_mm=78.0)
    axes.scatter(
        errors["duration"],
        errors["true"],
        s=6.0,
        facecolors="none",
        edgecolors=TRUE_COLOR,
        linewidths=0.35,
        alpha=float(np.clip(1000.0 / max(1, len(errors)), 0.25, 1.0)),
        rasterized=True,
        label=rf"true $e_{{{axis(component)}}}$",
    )
    low, high = change.limits
    points = axes.scatter(
        errors["duration"],
        errors["residual"],
        c=np.minimum(_individual_p_ml(evaluation)[is_drawn], 2.0 * P_ML_MAX),  # infinity has no colour
        cmap=change.colors,
        vmin=low,
        vmax=high,
        s=3.0,
        linewidths=0.0,
        rasterized=True,
        label=r"residual $e_{\mathrm{res}}$, coloured by $p_{\mathrm{ML}}$",
    )
    beyond = "max" if high > REDUCED else "neither"
    bar = figure.colorbar(points, ax=axes, extend=beyond, pad=0.02, ticks=np.linspace(low, high, 5))
    bar.set_label(r"$p_{\mathrm{ML}}$ [%]")
    bar.outline.set_linewidth(0.5)
    _label(axes, component, absolute=True)
    below = _set_decades(axes, errors[["true", "residual"]])
    headline = f"{len(errors)} of {len(evaluation)} errors are {change.name}"
    add_head_and_legend(figure, headline, lines(note, below), columns=2)
    for handle in figure.legends[0].legend_handles:
        if isinstance(handle, PathCollection):
            handle.set_sizes([12.0])
            if handle.get_array() is not None:
                handle.set(array=None, facecolor=change.colors(0.5))
    return figure


def _label(axes: Axes, component: str, *, absolute: bool) -> None:
    unit_name, _ = unit(component)
    signed = f"{in_words(component)} {symbol(component)} [{unit_name}]"
    axes.set_xlabel(DURATION_LABEL)
    axes.set_ylabel(size_label(component, unit_name) if absolute else signed)
    axes.set_xlim(left=0.0)
    if axes.get_xlim()[1] > WHOLE_DAYS:
        axes.xaxis.set_major_locator(MultipleLocator(1.0))
    if absolute:
        axes.set_ylim(bottom=0.0)


def _drawn_errors(evaluation: pd.DataFrame, component: str, *, absolute: bool) -> pd.DataFrame:
    """Return duration [d] and the three errors, in the unit they are drawn in."""
    _check_rows(evaluation)
    _, factor = unit(component)
    errors = evaluation[[curve.column for curve in _CURVES]] * factor
    return (errors.abs() if absolute else errors).assign(duration=evaluation["duration"] / DAY)


def _check_rows(table: pd.DataFrame) -> None:
    if table.empty:
        raise InputError("figure of errors: expected at least one row, got none")


def _p_ml(evaluation: pd.DataFrame) -> float:
    return metrics.p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())


def _individual_p_ml(evaluation: pd.DataFrame) -> np.ndarray:
    return metrics.individual_p_ml(evaluation["true"].to_numpy(), evaluation["predicted"].to_numpy())
