"""The picture of docs/learning.md with what corrections leave of SGP4's errors, by band of height and lead.

    python -m validation.pictures.catalogue_shares FOLDER

FOLDER has `scores.tsv` of `python -m validation.catalogue_seasons`, of which the season `summer` is drawn.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.base.epochs import calendar
from opml.element_sets.features import BANDS
from opml.figures.axis_labels import clauses
from opml.figures.display_names import display_learner
from opml.figures.style import MARKERS, MUTED, SERIES, TRUE_COLOR, add_head_and_legend, panel_figure
from validation.catalogue_seasons import ALL, SEASONS
from validation.pictures import shrunk

_COLUMNS = 4  # panels side by side
_SAME = 100.0  # share of SGP4's own errors [%]
_APART = 0.2  # days by which the marks of one lead are separated
_UNLEARNED = "density-scaled, without learning"


def shares(scores: pd.DataFrame, seasons: Mapping[str, Sequence[str]], *, name: str) -> Figure:
    """Draw the share of SGP4's median error [%] that is left, a panel per band, against the lead [d].

    scores: of one season; seasons: dates under `train` and `test`
    """
    bands = {_title(band, own): own for band, own in scores.groupby("band", sort=False)}
    learned = f"trained on half, {' to '.join(seasons['train'])}"
    judged = f"tested on the others, {' to '.join(seasons['test'])}"
    is_whole = scores["band"] == ALL
    whole, single = (_reach(scores[rows], "learned") for rows in (is_whole, ~is_whole))
    headline = f"Learned corrections: {whole} % of SGP4's median error over all heights, {single} % by band"

    def draw(axes: Axes, title: str) -> None:
        axes.axhline(_SAME, color=MUTED, lw=1.0, ls="--", label="SGP4")
        _draw_band(axes, bands[title])
        axes.set_xticks(sorted(set(bands[title]["lead"])))

    figure = panel_figure(list(bands), draw, columns=_COLUMNS, heights_mm=(20.0, 52.0))
    figure.supxlabel("lead time from the morning [d]", fontsize=8.0)
    figure.supylabel("median error [% of SGP4's]", fontsize=8.0)
    note = clauses(f"{name}: {learned}", judged, "bars: 95 % over weeks and objects")
    add_head_and_legend(figure, headline, note, columns=4)
    return figure


def _reach(scores: pd.DataFrame, model: str) -> str:
    """Return the least and the largest share."""
    medians = scores[f"{model}_median"].dropna()
    return f"{medians.min():.0f} to {medians.max():.0f}"


def _title(band: int, scores: pd.DataFrame) -> str:
    heights = "all heights" if band == ALL else f"{BANDS[band] / 1e3:g} to {BANDS[band + 1] / 1e3:g} km"
    return f"{heights}, {scores['objects'].max()} objects"


def _draw_band(axes: Axes, scores: pd.DataFrame) -> None:
    """Draw the marks of one band: the density-scaled prediction once, then each learner."""
    by_learner = dict(list(scores.groupby("learner", sort=False)))
    unlearned = next(iter(by_learner.values()))
    _mark(axes, unlearned, "scaled", 0, {"color": TRUE_COLOR, "marker": "x", "label": _UNLEARNED})
    for k, (learner, part) in enumerate(by_learner.items()):
        look = {"color": SERIES[k], "marker": MARKERS[k], "label": f"learned by {display_learner(learner)}"}
        _mark(axes, part, "learned", k + 1, look)


def _mark(axes: Axes, scores: pd.DataFrame, model: str, place: int, look: Mapping[str, Any]) -> None:
    middle, low, high = (scores[f"{model}_{part}"] for part in ("median", "low", "high"))
    at = scores["lead"] + _APART * (place - 1)
    # The interval of a skew statistic need not hold it.
    reach = [(middle - low).clip(lower=0.0), (high - middle).clip(lower=0.0)]
    axes.errorbar(at, middle, yerr=reach, ms=3.5, lw=1.0, elinewidth=0.8, capsize=1.5, **look)


def main(folder: str) -> None:
    """Draw the picture and shrink it."""
    scores = pd.read_csv(Path(folder, "scores.tsv"), sep="\t")
    season = SEASONS["summer"]
    dates = {"train": [*map(calendar, season.train)], "test": [*map(calendar, season.test)]}
    shrunk.save(shares(scores[scores["test"] == "summer"], dates, name=season.population), "catalogue")


if __name__ == "__main__":
    main(*sys.argv[1:])
