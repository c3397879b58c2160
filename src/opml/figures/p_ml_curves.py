"""Figures of P_ML against what an experiment varies: training data, orbit.

`metrics` are rows of that table, whose intervals are drawn as bars.
"""

from collections.abc import Mapping
from operator import attrgetter
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml import naming
from opml.base.errors import InputError
from opml.figures.axis_labels import (
    INTERVAL,
    NO_CORRECTION,
    P_ML,
    PAPER,
    VARIED,
    describe_training,
    in_words,
    lines,
    symbol,
)
from opml.figures.display_names import display_learner, display_rso, display_stations
from opml.figures.style import MARKERS, MUTED, PUBLISHED, RESIDUAL, SERIES, add_head_and_legend, column_figure
from opml.naming import Split

_APART = 0.02  # of two series of a curve, in parts of its length, so that equal points are seen


def partition_curve(
    metrics: pd.DataFrame, *, component: str = "e_y", published: Mapping[float, float] | None = None
) -> Figure:
    """Draw P_ML [%] against the share of the dataset trained on [%].

    After the paper's figure 'Performance metric P_ML of the SVM model trained by different size of training
    data'. Raises InputError without a row to draw.

    metrics: rows of random splits, of the test `rest` and, where they ran, of `seen`
    published: the paper's P_ML [%] by share
    """
    splits = metrics["train"].map(_training_split)
    points = metrics.assign(share=splits.map(attrgetter("percent")))
    points = points[(splits.map(attrgetter("kind")) == "random") & (metrics["component"] == component)]
    test, seen = points[points["test"] == "rest"], points[points["test"] == "seen"]
    if test.empty:
        raise InputError(f"partition curve: expected metrics of {component} on random splits, got none")

    figure, axes = column_figure(height_mm=74.0)
    _draw_curve(axes, test, "share", "o-", color=RESIDUAL, label="test part")
    if not seen.empty:
        _draw_curve(axes, seen, "share", "s--", color=MUTED, lw=1.0, ms=3.0, label="training part")
    if published:
        _draw_published(axes, published, label=f"{PAPER}, test part")
    axes.set_xlabel("training data [% of the dataset]")
    axes.set_xlim(0.0, 100.0)
    axes.set_xticks(range(0, 101, 10))
    best = test.loc[test["share"].idxmax(), ["share", "p_ml"]]
    headline = f"Trained on {best['share']:.0f} %, {best['p_ml']:.0f} % of the error remains"
    return _finish(figure, axes, points, component, headline)


def transfer_curve(
    metrics: pd.DataFrame,
    curve: str,
    targets: Mapping[str, float],
    *,
    component: str = "e_y",
    published: Mapping[str, Mapping[float, float]] | None = None,
) -> Figure:
    """Draw P_ML [%] on other RSOs against the element that they differ in, one line per future window.

    After the paper's figures 'ML-modified results on nearby new RSOs with i ranging from 48 deg to 54 deg'
    and '... with an increment of a'. Raises InputError without a row to draw.

    curve: the varied element, a key of VARIED
    targets: the RSOs to draw, with their element [deg or km]
    published: the paper's P_ML [%] by test and element
    """
    points = metrics[
        metrics["target"].isin(list(targets))
        & (metrics["component"] == component)
        & (metrics["test"].map(naming.parse_test).map(attrgetter("kind")) == "days")
    ]
    if points.empty:
        raise InputError(
            f"curve over RSOs: expected metrics of {component} on future windows of "
            f"{', '.join(targets) or 'some target'}, got none"
        )
    points = points.assign(varied=points["target"].map(targets), is_own=points["target"] == points["rso"])
    offset = _APART * np.ptp(list(targets.values()))
    figure, axes = column_figure(height_mm=80.0)
    for k, (test, rows) in enumerate(points.groupby("test", sort=False)):
        label, look = _window_label(test), {"color": _shade(k)}
        rows = rows.assign(varied=rows["varied"] + k * offset)
        # No line joins what the model was trained on to what it was not.
        for is_own, line in ((True, _marker(k)), (False, f"{_marker(k)}-")):
            _draw_curve(axes, rows[rows["is_own"] == is_own], "varied", line, label=label, **look)
        if published and test in published:
            papers = {value + k * offset: p_ml for value, p_ml in published[test].items()}
            _draw_published(axes, papers, label=PAPER)
    for value in points.loc[points["is_own"], "varied"].unique():
        axes.axvline(value, color=MUTED, ls=":", lw=1.2, zorder=1, label="RSO trained on")
    axes.set_xlabel(VARIED[curve])
    reach = points.loc[~points["is_own"], "p_ml"].agg(["min", "max"])
    headline = f"Other RSOs: {reach['min']:.0f} to {reach['max']:.0f} % of the error remains"
    return _finish(figure, axes, points, component, headline)


def _draw_curve(axes: Axes, rows: pd.DataFrame, x: str, style: str, **look: Any) -> None:
    """Draw P_ML against column `x`, one row per point."""
    if rows.duplicated([x]).any():
        raise InputError(f"curve of P_ML: {look['label']}: expected one row per point, got several")
    rows = rows.sort_values(x)
    axes.plot(rows[x], rows["p_ml"], style, zorder=3, **look)
    if "p_ml_low" in rows:
        axes.vlines(rows[x], rows["p_ml_low"], rows["p_ml_high"], color=look["color"], lw=0.9, zorder=2)


def _draw_published(axes: Axes, published: Mapping[float, float], *, label: str) -> None:
    axes.plot(
        list(published),
        list(published.values()),
        "D",
        markerfacecolor="none",
        markeredgecolor=PUBLISHED,
        markeredgewidth=1.1,
        markersize=6.0,
        zorder=4,
        label=label,
    )


def _finish(figure: Figure, axes: Axes, metrics: pd.DataFrame, component: str, headline: str) -> Figure:
    _label(axes, component)
    note = lines(_training_note(metrics), INTERVAL if "p_ml_low" in metrics else "")
    add_head_and_legend(figure, headline, note, columns=2)
    return figure


def _training_note(metrics: pd.DataFrame) -> str:
    """Return model, RSO, stations and rows trained on, where the table names them and they are the same."""
    if "rso" not in metrics:
        return ""
    stations = metrics["stations"].map(lambda name: naming.strip_seed(name, naming.NOISE)).unique()
    learner = metrics["learner"].iloc[0].partition("_s")[0]
    by = f" by {display_stations(stations[0])}" if len(stations) == 1 else ""
    return f"{display_learner(learner)} trained on {display_rso(metrics['rso'].iloc[0])}{by}{_rows(metrics)}"


def _rows(metrics: pd.DataFrame) -> str:
    trains = metrics["train"].unique()
    return f", {describe_training(trains[0])}" if len(trains) == 1 else ""


def _label(axes: Axes, component: str) -> None:
    """Name the axis of P_ML; no correction is marked where it is in range."""
    axes.set_ylabel(f"{P_ML} of the\n{in_words(component)} {symbol(component)} [%]")
    axes.set_ylim(bottom=0.0)
    if axes.get_ylim()[1] > NO_CORRECTION:
        axes.axhline(NO_CORRECTION, color=MUTED, ls="--", lw=1.0, zorder=1, label="no correction")


def _training_split(name: str) -> Split:
    return naming.parse_train(naming.strip_seed(name, naming.SPLIT))


def _window_label(test: str) -> str:
    split = naming.parse_test(test)
    first, last = split.days
    seen = ", new estimates" if split.starts_inside else ""
    return f"days {first:g} to {last:g}{seen}"


def _marker(k: int) -> str:
    return MARKERS[k % len(MARKERS)]


def _shade(k: int) -> str:
    return SERIES[k % len(SERIES)]
