"""Models against splits, one model on many RSOs, and what prediction intervals look like."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from opml.base.constants import DAY
from opml.figures.axis_labels import symbol, unit
from opml.figures.p_ml_curves import INTERVAL, NO_CORRECTION
from opml.figures.style import (
    MARKERS,
    MUTED,
    NOTE_SIZE,
    PREDICTED,
    PUBLISHED,
    RESIDUAL,
    SERIES,
    TRUE,
    legend,
    page_figure,
)

AXES = {
    "inclination": "inclination $i$ [deg]",
    "semi_major_axis": "increment of the semi-major axis $a$ [km]",
}


def splits(
    metrics: pd.DataFrame,
    *,
    panels: Sequence[str],
    learners: Sequence[str],
    splits: Sequence[str],
    published: Mapping[tuple[str, str], float],
    component: str,
    models: Mapping[str, str] | None = None,
    note: str = "",
) -> Figure:
    """P_ML [%] of every model under every split, with 90 % intervals; one panel per station set.

    `metrics` has a further column `split`, the split's name; `published`: the paper's, by station set and
    split; `models`: by learner what it is, in a few words; `note`: what was trained and tested.
    """
    figure = page_figure(height_mm=36.0 + 6.5 * len(learners))
    height = np.arange(len(learners))[::-1]
    for axes, stations in zip(
        figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0], panels, strict=True
    ):
        own = metrics[metrics["stations"] == stations]
        for k, split in enumerate(splits):
            rows = own[own["split"] == split].set_index("learner").loc[list(learners)]
            aside = height + 0.17 * ((len(splits) - 1) / 2.0 - k)
            look = {"color": SERIES[k % len(SERIES)], "marker": MARKERS[k % len(MARKERS)]}
            axes.hlines(aside, rows["p_ml_low"], rows["p_ml_high"], color=look["color"], lw=1.2)
            axes.plot(rows["p_ml"], aside, ls="", ms=4.0, label=split, **look)
            if (stations, split) in published:
                label = f"Peng & Bai, {split}"
                style = {"marker": look["marker"], "markerfacecolor": "none", "markeredgecolor": PUBLISHED}
                place = (
                    len(learners) - 1 - list(learners).index("svr") if "svr" in learners else len(learners)
                )
                axes.plot(published[stations, split], place, ls="", ms=7.0, label=label, zorder=4, **style)
        axes.axvline(NO_CORRECTION, color=MUTED, ls="--", lw=1.0, zorder=1)
        axes.set_title(stations, fontsize=8.0, loc="left")
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(rf"$P_{{\mathrm{{ML}}}}$ of {symbol(component)} [%]")
        axes.set_yticks(height, learners)
    _explain(figure.axes[-1], learners, models or {})
    legend(figure, columns=4, note="; ".join(filter(None, [note, INTERVAL])))
    return figure


def _explain(axes: Axes, learners: Sequence[str], models: Mapping[str, str]) -> None:
    """To the right of the panel, what each of its models is."""
    for height, name in enumerate(reversed(learners)):
        axes.annotate(
            models.get(name, ""),
            (1.02, height),
            xycoords=axes.get_yaxis_transform(),
            fontsize=NOTE_SIZE,
            color=PUBLISHED,
            va="center",
            annotation_clip=False,
        )


def transfers(
    metrics: pd.DataFrame,
    curves: Mapping[str, Mapping[str, float]],
    *,
    published: Mapping[str, float],
    component: str,
) -> Figure:
    """P_ML [%] of one model on other RSOs; one panel per curve, one line per learner.

    `curves`: by curve, a key of AXES, what is varied by target; `published`: the paper's, by target.
    """
    figure = page_figure(height_mm=78.0)
    panels = figure.subplots(1, len(curves), sharey=True, squeeze=False)[0]
    for axes, (curve, varied) in zip(panels, curves.items(), strict=True):
        for k, (learner, rows) in enumerate(metrics.groupby("learner", sort=False)):
            own = rows[rows["target"].isin(list(varied))].set_index("target").loc[list(varied)]
            x, color = list(varied.values()), SERIES[k % len(SERIES)]
            axes.fill_between(x, own["p_ml_low"], own["p_ml_high"], color=color, alpha=0.2, lw=0.0)
            axes.plot(x, own["p_ml"], f"{MARKERS[k % len(MARKERS)]}-", color=color, label=learner)
        points = {value: published[target] for target, value in varied.items() if target in published}
        style = {"markerfacecolor": "none", "markeredgecolor": PUBLISHED, "ms": 6.5}
        axes.plot(list(points), list(points.values()), "D", label="Peng & Bai", zorder=4, **style)
        axes.axhline(NO_CORRECTION, color=MUTED, ls="--", lw=1.0, zorder=1)
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel(AXES[curve])
    panels[0].set_ylabel(rf"$P_{{\mathrm{{ML}}}}$ of {symbol(component)} [%]")
    own = metrics[metrics["target"] == metrics["rso"]]
    for axes, varied in zip(panels, curves.values(), strict=True):
        for value in {varied[target] for target in own["target"] if target in varied}:
            axes.axvline(value, color=MUTED, ls=":", lw=1.2, zorder=1, label="RSO trained on")
    trained_on = f"trained on {metrics['rso'].iloc[0]} alone, applied to RSOs that differ in one element"
    legend(figure, columns=5, note=f"{trained_on}; bands: 5th to 95th percentile over resampled estimates")
    return figure


def intervals(tables: Mapping[str, pd.DataFrame], *, level: float, component: str, note: str = "") -> Figure:
    """True errors and what a correction leaves of them, in the band of the prediction interval.

    `tables`: `intervals` tables by title, one panel each, with its own scale; `note`: what was tested.
    """
    name, scale = unit(component)
    figure = page_figure(height_mm=68.0)
    for axes, (title, table) in zip(
        figure.subplots(1, len(tables), sharex=True, squeeze=False)[0], tables.items(), strict=True
    ):
        table = table.sort_values("duration", kind="stable")
        days, half = table["duration"] / DAY, scale * table["half_width"]
        outside = table["residual"].abs() > table["half_width"]
        look = {"ls": "", "marker": ".", "ms": 1.6, "mew": 0.0, "rasterized": True}
        axes.plot(days, scale * table["true"], color=TRUE, alpha=0.3, label="true error", **look)
        axes.plot(days, scale * table["residual"], color=RESIDUAL, label="what is left", **look)
        axes.fill_between(
            days,
            -half,
            half,
            color=PREDICTED,
            alpha=0.25,
            lw=0.0,
            zorder=1,
            label=f"{100.0 * level:g} % interval",
        )
        reach = 1.6 * max(half.max(), np.percentile((scale * table["residual"]).abs(), 99.0))
        axes.set_ylim(-reach, reach)
        axes.set_title(f"{title}: {100.0 * (1.0 - outside.mean()):.0f} % inside", fontsize=8.0, loc="left")
        axes.set_xlabel("prediction duration [d]")
    figure.axes[0].set_ylabel(f"{symbol(component)} [{name}]")
    legend(figure, columns=3, note=note)
    return figure
