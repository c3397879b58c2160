"""Figures of studies of real satellites: what an operator would have got, at a glance."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from opml.figures.axis_labels import lines
from opml.figures.line_ends import name_ends
from opml.figures.prediction_errors import DURATION_LABEL
from opml.figures.style import (
    ESTIMATE,
    MUTED,
    NOTE_SIZE,
    PREDICTED_COLOR,
    PUBLISHED,
    RESIDUAL,
    TRUE_COLOR,
    legend,
    page_figure,
)
from opml.figures.ticks import metres
from opml.learning.judge.errors_by_duration import at_days

BEFORE, PAPER, PLAIN, CHOSEN = (
    "no correction",
    "the paper's SVR",
    "best without learning",
    "chosen by the past",
)
"""What was flown: the labels of the tables below."""

LOOKS: dict[str, dict[str, Any]] = {
    BEFORE: {"color": TRUE_COLOR, "marker": "o"},
    PAPER: {"color": ESTIMATE, "marker": "D"},
    PLAIN: {"color": PREDICTED_COLOR, "marker": "s"},
    CHOSEN: {"color": RESIDUAL, "marker": "^"},
}
DAYS = [0.25 * k for k in range(1, 29)]
"""Durations that lines are drawn through."""

MARKS = (1, 2, 4, 7)
"""Durations that errors are told at; an orbit may be too short for the longest."""

AXIS = "along-track error $|e_y|$"


def sizes(table: pd.DataFrame, days: Sequence[float]) -> pd.DataFrame:
    """Return medians and 95th percentiles, as `at_days` names them, of a `replay` table by duration [d]."""
    return at_days(table.rename(columns={"before": "true", "e_y": "residual"}), days).set_index("day")


def headline(name: str, tables: Mapping[str, pd.DataFrame], *, note: str = "") -> Figure:
    """Draw medians of |e_y| [m] of one satellite by duration [d]; the title is what it comes to.

    name: of the satellite, and when
    tables: rows of `replay` tables of the same predictions, by BEFORE, PAPER, PLAIN and CHOSEN
    note: how the predictions were made
    """
    figure = page_figure(height_mm=92.0)
    axes = figure.add_subplot()
    drawn = {label: sizes(table, DAYS) for label, table in tables.items()}
    ends = {label: float(size["after_50"].iloc[-1]) for label, size in drawn.items()}
    for label, size in drawn.items():
        axes.plot(size.index, size["after_50"], **LOOKS[label] | {"ms": 3.0, "clip_on": False})
        if label in (BEFORE, CHOSEN):
            shade = {"color": LOOKS[label]["color"], "alpha": 0.15, "lw": 0.0}
            axes.fill_between(size.index, size["after_50"], size["after_95"], **shade)
    axes.set(yscale="log", xlabel=DURATION_LABEL, ylabel=AXIS, xlim=(0.0, drawn[CHOSEN].index[-1]))
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    named = {label: f"{label}: {metres(_rounded(end))}" for label, end in ends.items()}
    name_ends(
        axes,
        {named[label]: end for label, end in ends.items()},
        {named[label]: LOOKS[label]["color"] for label in ends},
    )
    before, after = (metres(_rounded(ends[label])) for label in (BEFORE, CHOSEN))
    message = f"{name}: {before} off after a week, {after} after correction"
    figure.suptitle(message, x=0.01, ha="left", fontsize=9.5)
    reading = lines(note, "lines: medians; bands: from the median up to the 95th percentile")
    axes.set_title(reading, loc="left", fontsize=NOTE_SIZE, color=PUBLISHED)
    return figure


def overview(
    satellites: Mapping[str, Mapping[str, pd.DataFrame]], altitudes: Mapping[str, float], *, note: str = ""
) -> Figure:
    """Draw medians of |e_y| [m] of satellites by altitude, after one day and after the last of MARKS.

    satellites: rows of `replay` tables by BEFORE, PLAIN and CHOSEN, by the satellite's name
    altitudes: [m], by the same names
    note: how the predictions were made
    """
    figure = page_figure(height_mm=80.0)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, days in zip(panels, (MARKS[:1], MARKS), strict=True):
        ticks = []
        for place, name in enumerate(sorted(altitudes, key=altitudes.__getitem__)):
            last = sizes(satellites[name][CHOSEN], days).index[-1]
            _draw_column(axes, place, satellites[name], last)
            ticks.append(f"{name}\n{1e-3 * altitudes[name]:.0f} km\nafter {last} d")
        axes.set_xticks(range(len(ticks)), ticks, fontsize=7.0)
        axes.set_xlim(-0.4, len(ticks) - 0.4)
        axes.grid(visible=False, axis="x")
    panels[0].set(ylabel=AXIS, yscale="log")
    panels[0].yaxis.set_major_formatter(FuncFormatter(metres))
    legend(figure, columns=3, note=note)
    return figure


def _draw_column(axes: Axes, place: int, tables: Mapping[str, pd.DataFrame], day: float) -> None:
    """Draw the errors of one satellite after a day, and tell those before and after correction."""
    medians = {label: float(sizes(table, [day])["after_50"].iloc[0]) for label, table in tables.items()}
    axes.vlines(place, min(medians.values()), max(medians.values()), color=MUTED, lw=0.7, zorder=1)
    for label, size in medians.items():
        shown = label if place == 0 else None
        axes.plot(place, size, **LOOKS[label] | {"ls": "", "ms": 5.5, "label": shown})
    for label in (BEFORE, CHOSEN):
        look: dict[str, Any] = {"color": LOOKS[label]["color"], "fontsize": 7.0, "va": "center"}
        text, point = metres(_rounded(medians[label])), (place, medians[label])
        axes.annotate(text, point, (6.0, 0.0), textcoords="offset points", **look)


def _rounded(size: float) -> float:
    """Return a size with two significant digits."""
    return float(f"{size:.2g}")
