"""A study's figures: errors before and after correction by duration, and the rows that were used."""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from opml.constants import DAY
from opml.errors import InputError
from opml.figures.labels import symbol
from opml.figures.style import MUTED, RESIDUAL, RESIDUALS, TRACK, TRUE, labelled, page_figure
from opml.learning.growth import by_duration

COLUMNS = 3
"""Panels side by side."""

BIN_DAYS = 0.5
LEAST_ROWS = 5
"""Rows that a bin of durations needs for its quantiles to say something."""

SHADES = (TRACK, *RESIDUALS, MUTED)
"""Of rows that are used, then of those that are not, reason by reason."""


def errors(evaluations: Mapping[str, pd.DataFrame], *, component: str) -> Figure:
    """Size of the errors before and after correction [m or m/s] by duration [d]; one panel per model.

    `evaluations`: those tables, by model. Lines are medians, the bands reach up to the 95th percentile.
    Raises InputError without a model.
    """
    if not evaluations:
        raise InputError("errors of a study: expected at least one model that corrects, got none")
    rows = math.ceil(len(evaluations) / COLUMNS)
    figure = page_figure(height_mm=14.0 + 50.0 * rows)
    panels = figure.subplots(rows, COLUMNS, squeeze=False, sharex=True, sharey=True).ravel()
    for axes, (name, evaluation) in zip(panels, evaluations.items(), strict=False):
        _draw_growth(axes, evaluation)
        axes.set_title(name, fontsize=8.0, loc="left")
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels[len(evaluations) :]:
        axes.remove()
    unit = "m/s" if component.startswith("e_v") else "m"
    figure.supxlabel(r"prediction duration $\Delta t$ [d]", fontsize=8.0)
    figure.supylabel(f"|{symbol(component)}| [{unit}]", fontsize=8.0)
    labels = labelled(figure)
    figure.legend(labels.values(), labels.keys(), loc="outside upper left", ncols=4)
    return figure


def _draw_growth(axes: Axes, evaluation: pd.DataFrame) -> None:
    """Median and 95th percentile before and after, in bins of the duration."""
    reach = evaluation["duration"].max() / DAY
    growth = by_duration(evaluation, width_days=min(BIN_DAYS, reach / 4.0))
    growth = growth[growth["rows"] >= LEAST_ROWS]
    for when, color, marker, label in (
        ("before", TRUE, "o", "no correction"),
        ("after", RESIDUAL, "^", "corrected"),
    ):
        median, most = growth[f"{when}_50"], growth[f"{when}_95"]
        axes.plot(growth["day"], median, f"{marker}-", color=color, ms=3.0, label=f"{label}, median")
        axes.fill_between(
            growth["day"], median, most, color=color, alpha=0.18, lw=0.0, label=f"{label}, to 95 %"
        )
    axes.set_yscale("log")


def drag(estimates: Mapping[str, pd.DataFrame], activity: pd.DataFrame) -> Figure:
    """Estimated Cd against time [d], beside F10.7 and Kp of the same days.

    `estimates`: those tables, by the window of their fits; what did not converge is left out. `activity`: the
    table `solar_activity`. The axis of Cd shows the middle 90 % of all estimates. Raises InputError without
    one.
    """
    usable = {name: table[table["converged"]] for name, table in estimates.items()}
    if all(table.empty for table in usable.values()):
        raise InputError("Cd of a study: expected an estimate that converged, got none")
    figure = page_figure(height_mm=104.0)
    upper, middle, lower = figure.subplots(3, 1, sharex=True, height_ratios=(2, 1, 1))
    for k, (name, table) in enumerate(usable.items()):
        look = {"ls": "", "marker": "o^sD"[k % 4], "ms": 2.2, "color": SHADES[k % len(SHADES)]}
        upper.plot(table["t"] / DAY, table["cd"], label=name, **look)
    every = pd.concat(list(usable.values()))
    low, high = np.quantile(every["cd"], [0.05, 0.95])
    upper.set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))
    upper.set_ylabel("estimated $C_d$")
    days = activity["t"] / DAY
    middle.plot(days, activity["f107"], color=TRUE, label="F10.7")
    middle.plot(days, activity["f107_mean"], color=MUTED, ls="--", label="81-day mean")
    middle.set_ylabel("F10.7 [sfu]")
    lower.plot(days, activity["kp_3h"], color=TRUE, lw=0.8, drawstyle="steps-post", label="$K_p$, 3 h")
    lower.set_ylabel("$K_p$")
    lower.set_xlim(every["t"].min() / DAY, every["t"].max() / DAY)
    lower.set_xlabel("time [d]")
    labels = labelled(figure)
    figure.legend(labels.values(), labels.keys(), loc="outside upper left", ncols=5)
    return figure


def rolling(days: Mapping[str, pd.DataFrame], *, every_days: float) -> Figure:
    """P_ML [%] by day of learners trained anew, beside the same ones trained once; one panel per learner.

    `days`: by learner, as `learning.rolling.by_day` returns; `every_days`: between two trainings. Raises
    InputError without a learner.
    """
    if not days:
        raise InputError("rolling of a study: expected at least one learner, got none")
    figure = page_figure(height_mm=16.0 + 42.0 * len(days))
    panels = figure.subplots(len(days), 1, squeeze=False, sharex=True).ravel()
    for axes, (name, table) in zip(panels, days.items(), strict=True):
        middle = table["day"] + 0.5 * every_days
        axes.plot(middle, table["once"], "o--", color=MUTED, ms=3.0, label="trained once")
        axes.plot(middle, table["anew"], "^-", color=RESIDUAL, ms=3.0, label="trained anew")
        axes.set_ylim(bottom=0.0)
        axes.set_title(name, fontsize=8.0, loc="left")
    figure.supxlabel("start of the prediction [d]", fontsize=8.0)
    figure.supylabel("$P_{ML}$ [%]", fontsize=8.0)
    labels = labelled(figure)
    figure.legend(labels.values(), labels.keys(), loc="outside upper left", ncols=2)
    return figure


def rows(shares: Mapping[str, Mapping[str, float]]) -> Figure:
    """Share of the rows that are used, and of those that are not by reason; one bar per dataset.

    `shares`: by the dataset's name, shares by reason, as `report.study.row_shares` returns. Raises InputError
    without a dataset.
    """
    if not shares:
        raise InputError("rows of a study: expected at least one dataset, got none")
    reasons = list(dict.fromkeys(reason for own in shares.values() for reason in own))
    figure = page_figure(height_mm=26.0 + 8.0 * len(shares) + 4.0 * math.ceil(len(reasons) / COLUMNS))
    axes = figure.add_subplot()
    place = np.arange(len(shares))[::-1]
    left = np.zeros(len(shares))
    for k, reason in enumerate(reasons):
        part = np.array([own.get(reason, 0.0) for own in shares.values()])
        axes.barh(place, part, left=left, height=0.6, color=SHADES[k % len(SHADES)], label=reason)
        left += part
    axes.set_yticks(place, list(shares))
    axes.set_xlim(0.0, 1.0)
    axes.xaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_xlabel("share of the predictions")
    axes.grid(visible=False, axis="y")
    figure.legend(loc="outside upper left", ncols=COLUMNS)
    return figure
