"""The numbers of the paper and those of combinations of readings, a strip of dots for each number."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from opml.base.errors import InputError
from opml.figures.axis_labels import tick_label
from opml.figures.display_names import display_learner
from opml.figures.style import MUTED, PREDICTED_COLOR, PUBLISHED, RESIDUAL, add_headline, page_figure
from opml.naming import Experiment

_MOST = 130.0
"""End of the axis [%]: corrections after which more remains are equally bad."""

_WIDTH = 0.5
_GOLDEN = 0.618034  # its multiples, without their whole part, spread dots evenly


def scan_dots(
    combinations: Mapping[str, Mapping[str, float]],
    published: Mapping[str, float],
    experiments: Mapping[str, Experiment],
    *,
    default: str,
    published_name: str = "Peng & Bai",
) -> Figure:
    """Draw P_ML [%] of published numbers, a dot per combination, the nearest and the default in colour.

    combinations: P_ML [%] by combination, the nearest first, and by number
    published: P_ML [%] by number
    experiments: what gives each number
    default: the combination of default readings

    Raises InputError without combinations.
    """
    if not combinations:
        raise InputError("scan: expected at least one combination of readings, got none")
    figure = page_figure(height_mm=100.0)
    axes = figure.add_subplot()
    nearest, places = next(iter(combinations)), np.arange(len(published))
    looks: dict[str, dict[str, Any]] = {
        nearest: {"color": RESIDUAL, "marker": "o", "label": f"nearest in the mean: {nearest}"},
        default: {"color": PREDICTED_COLOR, "marker": "s", "label": f"default: {display_learner(default)}"},
    }
    others: dict[str, Any] = {"color": MUTED, "marker": "o", "ms": 2.5, "alpha": 0.7, "zorder": 1}
    for k, (name, numbers) in enumerate(combinations.items()):
        heights = np.array([numbers[number] for number in published])
        look = {"ms": 5.0, "zorder": 3} | looks[name] if name in looks else others
        aside = 0.0 if name in looks else _WIDTH * (_GOLDEN * k % 1.0 - 0.5)
        is_beyond = heights > _MOST
        axes.plot(places + aside, np.where(is_beyond, np.nan, heights), ls="", **look)
        axes.plot((places + aside)[is_beyond], [_MOST] * is_beyond.sum(), ls="", **_beyond(look))
    marks: dict[str, Any] = {
        "color": PUBLISHED,
        "mfc": "none",
        "ms": 8.0,
        "zorder": 4,
        "label": published_name,
    }
    axes.plot(places, list(published.values()), "D", **marks)
    axes.set_ylim(0.0, _MOST)
    axes.set_ylabel(r"$P_{\mathrm{ML}}$ [%]")
    axes.grid(axis="x", visible=False)
    axes.set_xticks(places, [tick_label(experiments[number]) for number in published], fontsize="small")
    axes.legend(loc="upper left")
    note = f"{len(combinations)} combinations of interpretations, each one setting for all numbers"
    add_headline(
        axes, "No setting reproduces all numbers of the paper", f"{note}; triangles: above {_MOST:g} %"
    )
    return figure


def _beyond(look: Mapping[str, Any]) -> dict[str, Any]:
    """Return the look of dots beyond the end of the axis: triangles on it, which no legend names."""
    return {**look, "marker": "^", "clip_on": False, "label": "_beyond"}
