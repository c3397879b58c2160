"""The diagram of work and precision."""

from itertools import cycle
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from benchmarks.precision import Line, Panels, leads
from benchmarks.race import OURS
from opml.base.files import replacing
from opml.figures.style import (
    ESTIMATE,
    NOTE_SIZE,
    OBSERVED_COLOR,
    PREDICTED_COLOR,
    RESIDUAL,
    TRACK_COLOR,
    add_head_and_legend,
    page_figure,
)

LOOKS = {
    OURS: {"color": RESIDUAL, "marker": "o", "lw": 2.0, "zorder": 3},
    "satkit_gauss_jackson": {"color": PREDICTED_COLOR, "marker": "s"},
    "satkit": {"color": TRACK_COLOR, "marker": "D"},
    "heyoka": {"color": OBSERVED_COLOR, "marker": "^"},
    "orekit": {"color": ESTIMATE, "marker": "v"},
}
"""Of each peer's line."""


def work_precision(panels: Panels) -> Figure:
    """Draw milliseconds per arc-day against own error [m]; a panel for what is flown, a line per tool."""
    figure = page_figure(height_mm=96.0)
    for axes, (title, lines) in zip(
        figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0],
        panels.items(),
        strict=True,
    ):
        for name, line in lines.items():
            _draw(axes, name, line)
        _name(axes, lines[OURS])
        axes.set(xscale="log", yscale="log", xlabel="own error after seven days [m]")
        axes.margins(x=0.08, y=0.11)
        axes.set_title(title, fontsize=8.0, loc="left")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(numticks=12))
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())
    figure.axes[0].set_ylabel("processor time [ms per arc-day]")
    note = (
        "arcs of the paper's RSO on one core, five settings a tool (opml's: the longest step); "
        "down is faster, left is more precise"
    )
    headline = f"At equal precision opml is at least {min(leads(panels).values()):.0f} times faster"
    add_head_and_legend(figure, headline, note, columns=3)
    return figure


def _draw(axes: Axes, name: str, line: Line) -> None:
    axes.plot(
        [point.own_error for point in line.points],
        [point.cost for point in line.points],
        label=line.name,
        **LOOKS[name],
    )


def _name(axes: Axes, line: Line) -> None:
    """Write the settings of a line's points in turns below and above it, as neighbours may be near."""
    for point, (ha, va, aside) in zip(line.points, cycle([("right", "top", -4.0), ("left", "bottom", 4.0)])):
        axes.annotate(
            point.setting,
            (point.own_error, point.cost),
            xytext=(0.0, aside),
            textcoords="offset points",
            ha=ha,
            va=va,
            fontsize=NOTE_SIZE,
            color=LOOKS[OURS]["color"],
        )


def save(figure: Figure, path: Path) -> None:
    """Write the figure as PNG, whole or not at all."""
    with replacing(path) as temporary:
        figure.savefig(temporary, format="png", metadata={"Software": None})
