"""The paper's numbers as marks, and what combinations of readings give as lines."""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure

from opml.base.errors import InputError
from opml.figures.style import MUTED, PREDICTED, PUBLISHED, RESIDUAL, add_note, page_figure

MOST = 130.0
"""Where the axis ends [%]: a correction that leaves more than there was is as bad as any other."""


def scan(
    found: Mapping[str, Mapping[str, float]],
    published: Mapping[str, float],
    *,
    default: str,
    published_name: str = "Peng & Bai",
) -> Figure:
    """P_ML [%] of each of the `published` numbers; one line per combination, nearest and default in colour.

    `found`: by combination, the nearest first, P_ML by the number's name. Raises InputError without one.
    """
    if not found:
        raise InputError("scan: expected at least one combination of readings, got none")
    figure = page_figure(height_mm=96.0)
    axes = figure.add_subplot()
    nearest = next(iter(found))
    looks: dict[str, dict[str, Any]] = {
        nearest: {"color": RESIDUAL, "zorder": 3, "label": f"{nearest}, the nearest"},
        default: {"color": PREDICTED, "zorder": 3, "label": f"{default}, the default"},
    }
    others: dict[str, Any] = {"color": MUTED, "lw": 0.7, "alpha": 0.6, "zorder": 1}
    for name, numbers in found.items():
        axes.plot(list(published), [numbers[one] for one in published], "-", **looks.get(name, others))
    axes.plot(
        list(published),
        list(published.values()),
        "D",
        color=PUBLISHED,
        mfc="none",
        zorder=4,
        label=published_name,
    )
    axes.set_ylim(0.0, MOST)
    axes.set_ylabel(r"$P_{\mathrm{ML}}$ [%]")
    axes.set_xticks(range(len(published)), list(published), rotation=20, ha="right")
    axes.legend(loc="upper left")
    add_note(figure, f"lines: {len(found)} combinations of readings, each one setting for all numbers")
    return figure
