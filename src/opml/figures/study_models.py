"""Figure of a study: models against splits."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from opml.figures.axis_labels import INTERVAL, NO_CORRECTION, P_ML, clauses, in_words, symbol
from opml.figures.display_names import display_learner, display_stations
from opml.figures.style import MARKERS, MUTED, NOTE_SIZE, PUBLISHED, SERIES, add_head_and_legend, page_figure


def splits(
    metrics: pd.DataFrame,
    *,
    panels: Sequence[str],
    models: Mapping[str, str],
    splits: Sequence[str],
    component: str,
    note: str = "",
) -> Figure:
    """Draw P_ML [%] of every model under every split, with 90 % intervals; one panel per station set.

    metrics: that table with a further column `split`, the split's name
    models: what each learner is, in a few words
    """
    learners = list(models)
    figure = page_figure(height_mm=36.0 + 6.5 * len(learners))
    for axes, stations in zip(
        figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0], panels, strict=True
    ):
        rows = metrics[metrics["stations"] == stations]
        _draw_splits(axes, rows, learners, splits)
        axes.axvline(NO_CORRECTION, color=MUTED, ls="--", lw=1.0, zorder=1)
        axes.set_title(display_stations(stations), fontsize=8.0, loc="left")
        axes.set_xscale("log")
        axes.xaxis.set(major_locator=LogLocator(), major_formatter="{x:g}", minor_formatter=NullFormatter())
        axes.set_yticks(np.arange(len(learners))[::-1], learners)
    _explain(figure.axes[-1], models)
    figure.supxlabel(f"{P_ML} of the {in_words(component)} {symbol(component)} [%]", fontsize="medium")
    add_head_and_legend(figure, _flattered(rows, splits), clauses(note, INTERVAL), columns=6)
    return figure


def _flattered(metrics: pd.DataFrame, splits: Sequence[str]) -> str:
    """Return in words which learner the first split makes most of, against the last one."""
    by_split = metrics.pivot(index="learner", columns="split", values="p_ml")
    first, last = splits[0], splits[-1]
    most = (by_split[last] / by_split[first]).idxmax()
    ends = (f"{by_split.loc[most, split]:.3g} % on {split} rows" for split in (first, last))
    return f"The split decides: {display_learner(str(most))} has {P_ML} = {', '.join(ends)}"


def _draw_splits(axes: Axes, metrics: pd.DataFrame, learners: Sequence[str], splits: Sequence[str]) -> None:
    """Draw one station set: a line of marks per learner, a mark per split."""
    height = np.arange(len(learners))[::-1]
    for k, split in enumerate(splits):
        rows = metrics[metrics["split"] == split].set_index("learner").loc[list(learners)]
        aside = height + 0.17 * ((len(splits) - 1) / 2.0 - k)
        look: dict[str, Any] = {"color": SERIES[k % len(SERIES)], "marker": MARKERS[k % len(MARKERS)]}
        axes.hlines(aside, rows["p_ml_low"], rows["p_ml_high"], color=look["color"], lw=1.2)
        axes.plot(rows["p_ml"], aside, ls="", ms=4.0, label=split, **look)


def _explain(axes: Axes, models: Mapping[str, str]) -> None:
    for height, description in enumerate(reversed(list(models.values()))):
        axes.annotate(
            description,
            (1.02, height),
            xycoords=axes.get_yaxis_transform(),
            fontsize=NOTE_SIZE,
            color=PUBLISHED,
            va="center",
            annotation_clip=False,
        )
