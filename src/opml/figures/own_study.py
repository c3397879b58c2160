"""A study's figures: errors before and after correction by duration, and the rows that were used."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.axis_labels import symbol
from opml.figures.prediction_errors import DURATION_LABEL
from opml.figures.style import (
    MARKERS,
    MUTED,
    NOTE_SIZE,
    PREDICTED,
    RAMP,
    REASONS,
    RESIDUAL,
    SERIES,
    TRACK,
    TRUE,
    legend,
    page_figure,
)
from opml.learning.judge.errors_by_duration import REACH_DAYS, by_duration
from opml.learning.judge.model_choice import Mornings

COLUMNS = 3
"""Panels side by side."""

BIN_DAYS = 0.5
LEAST_ROWS = 5
"""Rows that a bin of durations needs for its quantiles to say something."""

UNCORRECTED = "errors without correction: medians and middle halves by the day that a prediction starts on"
"""What the errors beside Cd are."""

BASELINE = PREDICTED
"""Of models beside the one that a figure shows."""

SHADES = (TRACK, *REASONS)
"""Of rows that are used, then of those that are not, reason by reason."""


def errors(evaluations: Mapping[str, pd.DataFrame], *, component: str, note: str = "") -> Figure:
    """Size of the errors before and after correction [m or m/s] by duration [d]; one panel per model.

    `evaluations`: those tables, by model; `note`: what was trained and tested. Lines are medians, the bands
    reach up to the 95th percentile. Raises InputError without a model.
    """
    if not evaluations:
        raise InputError("errors of a study: expected at least one model that corrects, got none")
    rows = math.ceil(len(evaluations) / COLUMNS)
    figure = page_figure(height_mm=20.0 + 50.0 * rows)
    panels = figure.subplots(rows, COLUMNS, squeeze=False, sharex=True, sharey=True).ravel()
    for axes, (name, evaluation) in zip(panels, evaluations.items(), strict=False):
        _draw_growth(axes, evaluation)
        axes.set_title(name, fontsize=8.0, loc="left")
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels[len(evaluations) :]:
        axes.remove()
    figure.supxlabel(DURATION_LABEL, fontsize=8.0)
    figure.supylabel(_size_label(component), fontsize=8.0)
    legend(figure, columns=4, note=note)
    return figure


def residuals(mornings: Mornings, *, laws: Collection[str], note: str = "") -> Figure:
    """Size of e_y [m] by duration [d]: without correction, as flown, and as each model would have left it.

    `mornings`: of one dataset; `laws`: the models that learned. Of the errors without correction and of what
    was flown, bands hold 50 and 90 %; of the models there are medians.
    """
    figure = page_figure(height_mm=100.0)
    axes = figure.add_subplot()
    before, after = (sizes(mornings.flown, column) for column in ("before", "e_y"))
    _draw_bands(axes, before, TRUE, "o", "no correction")
    _draw_bands(axes, after, RESIDUAL, "^", "corrected by what the past chose")
    others = {name: sizes(table, "e_y") for name, table in mornings.tables.items() if name != "none"}
    for name, median in others.items():
        look: dict[str, Any] = (
            {"ls": "--", "label": "learned"} if name in laws else {"label": "nothing learned"}
        )
        axes.plot(median.index, median["50"], color=BASELINE, lw=0.9, zorder=2.5, **look)
    axes.set_yscale("log")
    axes.set_xlim(0.0, before.index[-1])
    axes.set_xlabel(DURATION_LABEL)
    axes.set_ylabel(_size_label("e_y"))
    _name_ends(axes, {name: float(median["50"].iloc[-1]) for name, median in others.items()})
    reading = "lines: medians; bands: the middle 50 % and 90 % of the errors"
    legend(figure, columns=4, note="\n".join(filter(None, [note, reading])))
    return figure


def sizes(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Percentiles 5 to 95 of the size of an error in bins of BIN_DAYS, by their mean duration [d]."""
    days, size = table["duration"] / DAY, table[column].abs()
    width = min(BIN_DAYS, days.max() / 4.0)
    bins = size.groupby(np.ceil(days / width))
    found = bins.quantile([0.05, 0.25, 0.5, 0.75, 0.95]).unstack()
    found = found.set_axis(days.groupby(np.ceil(days / width)).mean(), axis=0)
    return found.set_axis(["5", "25", "50", "75", "95"], axis=1)[(bins.size() >= LEAST_ROWS).to_numpy()]


def _draw_bands(axes: Axes, found: pd.DataFrame, color: str, marker: str, label: str) -> None:
    """Median, middle half and middle 90 % of the sizes of an error."""
    axes.fill_between(found.index, found["5"], found["95"], color=color, alpha=0.12, lw=0.0)
    axes.fill_between(found.index, found["25"], found["75"], color=color, alpha=0.25, lw=0.0)
    axes.plot(found.index, found["50"], f"{marker}-", color=color, ms=3.5, zorder=3.0, label=label)


def _name_ends(axes: Axes, ends: Mapping[str, float]) -> None:
    """The names of lines at their right ends, pushed apart on the logarithmic axis."""
    low, high = np.log10(axes.get_ylim())
    names = sorted(ends, key=ends.__getitem__)
    for name, place in zip(names, _apart([ends[name] for name in names], 0.042 * (high - low)), strict=True):
        axes.annotate(
            name,
            (1.0, ends[name]),
            xycoords=axes.get_yaxis_transform(),
            xytext=(1.03, place),
            textcoords=axes.get_yaxis_transform(),
            arrowprops={"arrowstyle": "-", "color": BASELINE, "lw": 0.5, "shrinkA": 1.0, "shrinkB": 1.0},
            fontsize=NOTE_SIZE,
            color=BASELINE,
            va="center",
            annotation_clip=False,
        )


def _apart(values: Sequence[float], least: float) -> np.ndarray:
    """Ascending values moved as far apart as `least` [powers of ten], as many up as down."""
    wanted = np.log10(np.asarray(values, float))
    steps = least * np.arange(len(wanted))
    apart = np.maximum.accumulate(wanted - steps) + steps
    places: np.ndarray = 10.0 ** (apart - np.mean(apart - wanted) if len(wanted) else apart)
    return places


def _size_label(component: str) -> str:
    unit = "m/s" if component.startswith("e_v") else "m"
    return f"|{symbol(component)}| [{unit}]"


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


def drag(
    estimates: Mapping[str, pd.DataFrame],
    activity: pd.DataFrame,
    errors: pd.DataFrame | None = None,
    *,
    note: str = "",
) -> Figure:
    """Estimated Cd against time [d], above F10.7 and Kp of the same days and the errors of predictions.

    `estimates`: those tables, by the window of their fits; what did not converge is left out. `activity`: the
    table `solar_activity`. `errors`: as `daily_errors` returns. The axis of Cd shows the middle 90 % of all
    estimates. Raises InputError without one.
    """
    usable = {name: table[table["converged"]] for name, table in estimates.items()}
    if all(table.empty for table in usable.values()):
        raise InputError("Cd of a study: expected an estimate that converged, got none")
    drawn = errors is not None and not errors.empty
    figure = page_figure(height_mm=(140.0 if drawn else 110.0))
    panels = figure.subplots(3 + drawn, 1, sharex=True, height_ratios=(2.0, 1.0, 1.0, 1.6)[: 3 + drawn])
    _draw_cd(panels[0], usable)
    _draw_activity(panels[1], panels[2], activity)
    if errors is not None and drawn:
        _draw_daily(panels[3], errors)
    every = pd.concat(list(usable.values()))
    panels[-1].set_xlim(every["t"].min() / DAY, every["t"].max() / DAY)
    panels[-1].set_xlabel("time [d]")
    figure.align_ylabels()
    legend(figure, columns=5, note=note)
    return figure


def _draw_cd(axes: Axes, usable: Mapping[str, pd.DataFrame]) -> None:
    """Estimates of Cd, the longest window in front."""
    for k, (name, table) in enumerate(usable.items()):
        look: dict[str, Any] = {
            "ls": "",
            "marker": MARKERS[k % len(MARKERS)],
            "ms": 2.2,
            "color": RAMP[k % len(RAMP)],
        }
        axes.plot(table["t"] / DAY, table["cd"], label=name, **look)
    low, high = np.quantile(pd.concat(list(usable.values()))["cd"], [0.05, 0.95])
    axes.set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))
    axes.set_ylabel("estimated $C_d$")


def _draw_activity(upper: Axes, lower: Axes, activity: pd.DataFrame) -> None:
    """F10.7 with its mean above Kp."""
    days = activity["t"] / DAY
    upper.plot(days, activity["f107"], color=TRUE, label="F10.7")
    upper.plot(days, activity["f107_mean"], color=MUTED, ls="--", label="81-day mean")
    upper.set_ylabel("F10.7 [sfu]")
    lower.plot(days, activity["kp_3h"], color=PREDICTED, lw=0.9, drawstyle="steps-post", label="$K_p$, 3 h")
    lower.set_ylabel("$K_p$")


def daily_errors(dataset: pd.DataFrame, *, component: str, day: float) -> pd.DataFrame:
    """Quartiles of the size of the kept errors of predictions over `day` days, by calendar day of t_i.

    Columns t (middle of the day) [s], 25, 50 and 75 in the component's unit. Durations up to a quarter of a
    day from it count.
    """
    near = (dataset["duration"] / DAY - day).abs() <= REACH_DAYS
    rows = dataset[near & dataset["keep"]]
    calendar = np.floor(rows["t_i"] / DAY)
    groups = rows[component].abs().groupby(calendar)
    found = pd.DataFrame({f"{100.0 * share:.0f}": groups.quantile(share) for share in (0.25, 0.5, 0.75)})
    middle = (found.index.to_numpy(float) + 0.5) * DAY
    return found.assign(t=middle, day=day).reset_index(drop=True)


def _draw_daily(axes: Axes, errors: pd.DataFrame) -> None:
    """Medians and middle halves of errors by the day that a prediction starts on, a line per duration."""
    for k, (day, own) in enumerate(errors.groupby("day")):
        color = SERIES[k % len(SERIES)]
        axes.fill_between(own["t"] / DAY, own["25"], own["75"], color=color, alpha=0.2, lw=0.0)
        look: dict[str, Any] = {"ms": 2.5, "lw": 1.0, "color": color, "label": f"error after {day:g} d"}
        axes.plot(own["t"] / DAY, own["50"], f"{MARKERS[k % len(MARKERS)]}-", **look)
    axes.set_yscale("log")
    axes.set_ylabel("size of the\nerror [m]")


def rolling(days: Mapping[str, pd.DataFrame], *, every_days: float, note: str = "") -> Figure:
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
    figure.supylabel(r"$P_{\mathrm{ML}}$ [%]", fontsize=8.0)
    legend(figure, columns=2, note=note)
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
        axes.barh(
            place, part, left=left, height=0.6, color=SHADES[k % len(SHADES)], label=_reason(reason, part)
        )
        left += part
    axes.set_yticks(place, list(shares))
    axes.set_xlim(0.0, 1.0)
    axes.xaxis.set_major_formatter(PercentFormatter(1.0))
    axes.set_xlabel("share of the predictions")
    axes.grid(visible=False, axis="y")
    legend(figure, columns=COLUMNS)
    return figure


def _reason(reason: str, parts: np.ndarray) -> str:
    """A reason with the shares that it has, as a thin bar cannot be read."""
    low, high = f"{parts.min():.1%}", f"{parts.max():.1%}"
    return f"{reason}, {low}" if low == high else f"{reason}, {low} to {high}"
