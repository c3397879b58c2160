"""Figures of a study of one's own: errors by duration, Cd and the weather, P_ML by day."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.base.constants import DAY
from opml.figures.axis_labels import lines, size_label
from opml.figures.display_names import display_learner
from opml.figures.line_ends import name_ends
from opml.figures.style import (
    MARKERS,
    MUTED,
    NOTE_SIZE,
    PREDICTED_COLOR,
    PUBLISHED,
    RAMP,
    RESIDUAL,
    SERIES,
    TRUE_COLOR,
    add_head_and_legend,
    add_note,
    page_figure,
    screen_figure,
)
from opml.figures.ticks import mark_dates, metres, rounded
from opml.learning.judge.errors_by_duration import REACH_DAYS
from opml.learning.judge.model_choice import Mornings
from opml.tables.convergence import none_converged

BIN_DAYS = 0.5
LEAST_ROWS = 5
"""Rows that a bin of durations needs for its quantiles to say something, where any bin has so many."""

UNCORRECTED_NOTE = "errors without correction: medians and middle halves by a prediction's first day"
"""Note on the errors below Cd."""

BASELINE = PREDICTED_COLOR  # colour of the models other than the one that a figure shows
OUTSIDE = 0.3  # room above and below the middle 90 % of the estimates of Cd, in parts of their range


def residuals(mornings: Mornings, *, laws: Collection[str], note: str = "") -> Figure:
    """Draw sizes of e_y [m] by duration [d]: without correction, as selected, and by each model.

    Errors without correction and errors of what was selected have bands of 50 and 90 %; models have medians.
    Named are the model chosen last, the best without learning, the best that learned, and the paper's.

    laws: the models that learned
    """
    figure = screen_figure(height_mm=105.0)
    axes = figure.add_subplot()
    before, after = (sizes(mornings.selected, column) for column in ("before", "e_y"))
    _draw_bands(axes, before, TRUE_COLOR, "o", "no correction")
    _draw_bands(axes, after, RESIDUAL, "^", "model selected each day")
    medians = {name: sizes(table, "e_y")["50"] for name, table in mornings.tables.items() if name != "none"}
    named = _to_name(mornings, laws)
    for name, median in medians.items():
        look: dict[str, Any] = {"ls": "--" if name in laws else "-", "lw": 0.6, "color": MUTED}
        if name in named:
            look |= {"lw": 1.2, "color": BASELINE, "label": "learned" if name in laws else "without learning"}
        axes.plot(median.index, median, zorder=2.5, **look)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    axes.set_xlim(0.0, before.index[-1])
    axes.set_xlabel("prediction duration [d]")
    axes.set_ylabel(size_label("e_y", "m").removesuffix(" [m]"))  # its ticks have the unit
    ends = {display_learner(name): float(medians[name].iloc[-1]) for name in named}
    name_ends(axes, ends, dict.fromkeys(ends, BASELINE))
    bands = "lines: medians, grey: other models; bands: middle 50 % and 90 % of the errors"
    selected, without = (metres(rounded(float(one["50"].iloc[-1]))) for one in (after, before))
    headline = f"After {after.index[-1]:.2g} d: median {selected}, uncorrected {without}"
    add_head_and_legend(figure, headline, lines(note, bands), columns=2)
    return figure


def _to_name(mornings: Mornings, laws: Collection[str]) -> list[str]:
    """Return the models that a figure names: chosen last, the best of both kinds, and the paper's."""
    names = [name for name in mornings.tables if name != "none"]
    plain, learned = [name for name in names if name not in laws], [name for name in names if name in laws]
    best = {mornings.best(kind) for kind in (plain, learned) if kind}
    return [name for name in names if name in best | {mornings.last_choice, "svr"}]


def sizes(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return percentiles 5 to 95 of the size of an error in bins of BIN_DAYS, by their mean duration [d].

    table: with a column `duration` [s]
    column: of the error
    """
    days, size = table["duration"] / DAY, table[column].abs()
    width = min(BIN_DAYS, days.max() / 4.0)
    bins = size.groupby(np.ceil(days / width))
    percentiles = bins.quantile([0.05, 0.25, 0.5, 0.75, 0.95]).unstack()
    percentiles = percentiles.set_axis(days.groupby(np.ceil(days / width)).mean(), axis=0)
    enough = bins.size().to_numpy() >= LEAST_ROWS
    return percentiles.set_axis(["5", "25", "50", "75", "95"], axis=1)[enough if enough.any() else ~enough]


def _draw_bands(axes: Axes, percentiles: pd.DataFrame, color: str, marker: str, label: str) -> None:
    """Draw the median, the middle half and the middle 90 % of the sizes of an error."""
    days = percentiles.index
    axes.fill_between(days, percentiles["5"], percentiles["95"], color=color, alpha=0.12, lw=0.0)
    axes.fill_between(days, percentiles["25"], percentiles["75"], color=color, alpha=0.25, lw=0.0)
    look: dict[str, Any] = {"ms": 3.5, "zorder": 3.0, "label": label, "clip_on": False}
    axes.plot(days, percentiles["50"], f"{marker}-", color=color, **look)


def drag_figure(
    estimates: Mapping[str, pd.DataFrame],
    activity: pd.DataFrame,
    errors: pd.DataFrame | None = None,
    *,
    epoch: str,
    manoeuvres: Sequence[float] = (),
    note: str = "",
) -> Figure:
    """Draw estimated Cd against time [d], above F10.7 and Kp of the same days and the errors of predictions.

    The axis of Cd shows the middle 90 % of all estimates, and at its edges which others there are. Raises
    InputError where no estimate converged.

    estimates: those tables, by the window of their fits; what did not converge is left out
    activity: `solar_activity` table
    errors: as `daily_errors` returns, None for no panel of them
    manoeuvres: times [s]
    """
    usable = {name: table[table["converged"]] for name, table in estimates.items()}
    if all(table.empty for table in usable.values()):
        raise none_converged("Cd of a study", estimates.values())
    drawn = errors is not None and not errors.empty
    figure = page_figure(height_mm=(140.0 if drawn else 110.0))
    panels = figure.subplots(3 + drawn, 1, sharex=True, height_ratios=(2.0, 1.0, 1.0, 1.6)[: 3 + drawn])
    _draw_cd(panels[0], usable)
    _draw_activity(panels[1], panels[2], activity)
    if errors is not None and drawn:
        _draw_daily(panels[3], errors)
    every = pd.concat(list(usable.values()))
    panels[-1].set_xlim(every["t"].min() / DAY, every["t"].max() / DAY)
    mark_dates(panels[-1], epoch)
    for axes in panels:
        for t in manoeuvres:
            label = "manoeuvre" if axes is panels[0] else None
            axes.axvline(t / DAY, color=RESIDUAL, ls=":", lw=1.2, zorder=1, label=label)
        entries = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
        place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.05)}
        axes.legend(entries.values(), entries.keys(), fontsize=NOTE_SIZE, **place)
    figure.align_ylabels()
    add_note(figure, note)
    return figure


def _draw_cd(axes: Axes, usable: Mapping[str, pd.DataFrame]) -> None:
    for k, (name, table) in enumerate(usable.items()):
        look: dict[str, Any] = {"ls": "", "ms": 2.2, "color": RAMP[k % len(RAMP)], "label": name}
        axes.plot(table["t"] / DAY, table["cd"], marker=MARKERS[k % len(MARKERS)], **look)
    every = pd.concat(list(usable.values()))
    low, high = np.quantile(every["cd"], [0.05, 0.95])
    room = OUTSIDE * (high - low)
    axes.set_ylim(low - room, high + room)
    axes.set_ylabel("estimated $C_d$")
    _mark_outside(axes, every)


def _mark_outside(axes: Axes, every: pd.DataFrame) -> None:
    """Mark at the edges of an axis the estimates of Cd that lie beyond it, and count them."""
    low, high = axes.get_ylim()
    below, above = every[every["cd"] < low], every[every["cd"] > high]
    for beyond, edge, marker in ((below, low, "v"), (above, high, "^")):
        look: dict[str, Any] = {"ls": "", "ms": 3.5, "mfc": "white", "mec": TRUE_COLOR, "mew": 0.6}
        axes.plot(beyond["t"] / DAY, np.full(len(beyond), edge), marker, clip_on=False, zorder=4.0, **look)
    if count := len(below) + len(above):
        shown = f"{count} of {len(every)} estimates lie beyond the axis: triangles at its edges"
        axes.set_title(shown, fontsize=NOTE_SIZE, color=PUBLISHED, loc="right")


def _draw_activity(upper: Axes, lower: Axes, activity: pd.DataFrame) -> None:
    days = activity["t"] / DAY
    upper.plot(days, activity["f107"], color=TRUE_COLOR, label="F10.7")
    upper.plot(days, activity["f107_mean"], color=MUTED, ls="--", label="its 81-day mean")
    upper.set_ylabel("F10.7 [sfu]")
    lower.plot(days, activity["kp_3h"], PREDICTED_COLOR, lw=0.9, drawstyle="steps-post", label="$K_p$, 3 h")
    lower.set_ylabel("$K_p$")


def daily_errors(dataset: pd.DataFrame, *, component: str, day: float) -> pd.DataFrame:
    """Return quartiles of the size of kept errors by the calendar day of t_i.

    Columns: t, the middle of the day [s]; 25, 50 and 75 in the component's unit; day.

    day: duration of the predictions [d]; durations up to a quarter of a day from it count
    """
    near = (dataset["duration"] / DAY - day).abs() <= REACH_DAYS
    rows = dataset[near & dataset["keep"]]
    calendar = np.floor(rows["t_i"] / DAY)
    groups = rows[component].abs().groupby(calendar)
    quartiles = pd.DataFrame({f"{100.0 * share:.0f}": groups.quantile(share) for share in (0.25, 0.5, 0.75)})
    middle = (quartiles.index.to_numpy(float) + 0.5) * DAY
    return quartiles.assign(t=middle, day=day).reset_index(drop=True)


def _draw_daily(axes: Axes, errors: pd.DataFrame) -> None:
    """Draw medians and middle halves of errors by the predictions' first day, a line per duration."""
    for k, (day, quartiles) in enumerate(errors.groupby("day")):
        color, days = SERIES[k % len(SERIES)], quartiles["t"] / DAY
        axes.fill_between(days, quartiles["25"], quartiles["75"], color=color, alpha=0.2, lw=0.0)
        look: dict[str, Any] = {"ms": 2.5, "lw": 1.0, "color": color, "label": f"after {day:g} d"}
        axes.plot(days, quartiles["50"], f"{MARKERS[k % len(MARKERS)]}-", **look)
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    axes.set_ylabel("size of the\nerror")
