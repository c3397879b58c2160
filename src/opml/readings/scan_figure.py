"""The numbers of the paper as marks, and those of combinations of readings as lines."""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from opml.base.errors import InputError
from opml.figures.axis_labels import tick_label
from opml.figures.display_names import display_learner
from opml.figures.style import MUTED, PREDICTED_COLOR, PUBLISHED, RESIDUAL, add_note, page_figure
from opml.naming import Experiment

_MOST = 130.0
"""End of the axis [%]: corrections that leave more than this are equally bad."""


def scan_curves(
    combinations: Mapping[str, Mapping[str, float]],
    published: Mapping[str, float],
    experiments: Mapping[str, Experiment],
    *,
    default: str,
    published_name: str = "Peng & Bai",
) -> Figure:
    """Draw P_ML [%] of published numbers, one line per combination, the nearest and the default in colour.

    combinations: P_ML [%] by combination, the nearest first, and by number
    published: P_ML [%] by number
    experiments: what gives each number
    default: the combination of default readings

    Raises InputError without combinations.
    """
    if not combinations:
        raise InputError("scan: expected at least one combination of readings, got none")
    figure = page_figure(height_mm=96.0)
    axes = figure.add_subplot()
    nearest = next(iter(combinations))
    looks: dict[str, dict[str, Any]] = {
        nearest: {"color": RESIDUAL, "zorder": 3, "label": f"{nearest}, the nearest"},
        default: {"color": PREDICTED_COLOR, "zorder": 3, "label": f"{display_learner(default)}, the default"},
    }
    others: dict[str, Any] = {"color": MUTED, "lw": 0.7, "alpha": 0.6, "zorder": 1}
    for name, numbers in combinations.items():
        heights = [numbers[number] for number in published]
        axes.plot(list(published), heights, "-", **looks.get(name, others))
    axes.plot(
        list(published),
        list(published.values()),
        "D",
        color=PUBLISHED,
        mfc="none",
        zorder=4,
        label=published_name,
    )
    axes.set_ylim(0.0, _MOST)
    axes.set_ylabel(r"$P_{\mathrm{ML}}$ [%]")
    labels = [tick_label(experiments[number]) for number in published]
    axes.set_xticks(range(len(published)), labels, fontsize="small")
    axes.legend(loc="upper left")
    add_note(figure, f"lines: {len(combinations)} combinations of readings, each one setting for all numbers")
    return figure
