"""Figures of what predictions leave of SGP4's errors: by band of height and lead, and test by test."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.element_sets.corrector_scores import ALL
from opml.element_sets.features import BANDS
from opml.figures.axis_labels import clauses
from opml.figures.display_names import display_learner
from opml.figures.style import (
    MARKERS,
    MUTED,
    NOTE_SIZE,
    SERIES,
    TRUE_COLOR,
    add_head_and_legend,
    panel_figure,
)

_COLUMNS = 4  # panels side by side
_SAME = 100.0  # share of SGP4's own errors [%]
_HIGHEST = 130.0  # end of the axis of shares [%]
_APART = 0.2  # days by which the marks of one lead are separated

_INTERVALS = "bars: 95 % over weeks and objects"
_UNLEARNED = "density-scaled, without learning"


def shares(scores: pd.DataFrame, seasons: Mapping[str, Sequence[str]], *, name: str) -> Figure:
    """Draw the share of SGP4's median error [%] that is left, a panel per band, against the lead [d].

    scores: `catalogue_scores` of one test
    seasons: dates under `train` and `test`
    """
    bands = {_title(band, own): own for band, own in scores.groupby("band", sort=False)}
    learned = f"trained on half, {' to '.join(seasons['train'])}"
    judged = f"tested on the others, {' to '.join(seasons['test'])}"
    is_whole = scores["band"] == ALL
    whole, single = (_reach(scores[rows], "learned") for rows in (is_whole, ~is_whole))
    headline = f"Learned corrections: {whole} % of SGP4's median error over all heights, {single} % by band"
    return _panels(bands, _draw_band, headline, clauses(f"{name}: {learned}", judged, _INTERVALS))


def every_season(scores: pd.DataFrame, labels: Mapping[str, str]) -> Figure:
    """Draw what improved sets leave of SGP4's median error [%], a panel per test, against the lead [d].

    scores: `catalogue_scores`, of which the first learner of each test counts
    labels: what each test that is drawn is about, as panels name it
    """
    is_first = scores["learner"] == scores["learner"].iloc[0]
    whole = scores[is_first & (scores["band"] == ALL) & scores["test"].isin(labels)]
    tests = dict(list(whole.groupby("test", sort=False)))

    def draw(axes: Axes, scores: pd.DataFrame) -> None:
        _mark(axes, scores, "scaled", 0, {"color": TRUE_COLOR, "marker": "x", "label": _UNLEARNED})
        look = {"color": SERIES[0], "marker": MARKERS[0], "label": "sets improved by opml improve"}
        _mark(axes, scores, "improved", 1, look)
        count = f"{scores['objects'].max()} objects"
        axes.text(0.03, 0.03, count, transform=axes.transAxes, fontsize=NOTE_SIZE, color=MUTED)

    below = f"{(whole['improved_high'] < _SAME).sum()} of {len(whole)} bars are below it"
    headline = f"Improved sets: {_reach(whole, 'improved')} % of SGP4's median error; {below}"
    note = clauses("objects not used in training, on the dates given", f"{_INTERVALS}, cut at the axis")
    figure = _panels(tests, draw, headline, note)
    for axes, test in zip(figure.axes, tests, strict=True):
        axes.set_title(labels[str(test)], fontsize=8.0, loc="left")
    # One wide bar would squeeze all panels.
    highest = whole[["improved_median", "scaled_median"]].max(axis=None)
    figure.axes[0].set_ylim(0.0, max(_HIGHEST, 1.05 * highest))
    return figure


def _reach(scores: pd.DataFrame, model: str) -> str:
    """Return the least and the largest share."""
    medians = scores[f"{model}_median"].dropna()
    return f"{medians.min():.0f} to {medians.max():.0f}"


def _panels(
    parts: Mapping[str, pd.DataFrame], draw: Callable[[Axes, pd.DataFrame], None], headline: str, note: str
) -> Figure:
    def draw_part(axes: Axes, title: str) -> None:
        axes.axhline(_SAME, color=MUTED, lw=1.0, ls="--", label="SGP4")
        draw(axes, parts[title])
        axes.set_xticks(sorted(set(parts[title]["lead"])))

    figure = panel_figure(list(parts), draw_part, columns=_COLUMNS, heights_mm=(20.0, 52.0))
    figure.supxlabel("lead time from the morning [d]", fontsize=8.0)
    figure.supylabel("median error [% of SGP4's]", fontsize=8.0)
    add_head_and_legend(figure, headline, note, columns=4)
    return figure


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
