"""A figure of what predictions are worth where objects may collide."""

import pandas as pd
from matplotlib.figure import Figure

from opml.base.errors import InputError
from opml.figures.display_names import display_learner
from opml.figures.style import (
    ESTIMATE,
    MARKERS,
    OBSERVED_COLOR,
    PREDICTED_COLOR,
    RESIDUAL,
    TRACK_COLOR,
    TRUE_COLOR,
    add_head_and_legend,
    page_figure,
)
from opml.learning.data.error_components import UNCORRECTED
from opml.learning.judge.model_choice import CHOSEN
from opml.tables import ANY_CROSSING

_COLORS = (TRUE_COLOR, PREDICTED_COLOR, OBSERVED_COLOR, RESIDUAL, ESTIMATE, TRACK_COLOR)
_MARKERS = f"{MARKERS}vP"


def by_duration(table: pd.DataFrame, *, note: str = "") -> Figure:
    """Draw alarms per collision and the share of collisions that is flagged, a line per row of the report.

    table: `conjunctions`

    Raises InputError for an empty table.
    """
    if table.empty:
        raise InputError("conjunctions: expected predictions that state a size, got none")
    figure = page_figure(height_mm=84.0)
    alarms, flagged = figure.subplots(1, 2)
    whole = table[table["crossing"] == ANY_CROSSING]
    for k, ((model, covariance), rows) in enumerate(whole.groupby(["model", "covariance"], sort=False)):
        name = "no correction" if model == UNCORRECTED else display_learner(str(model))
        look = {"color": _COLORS[k % len(_COLORS)], "marker": _MARKERS[k % len(_MARKERS)]}
        look |= {"label": f"{name}, covariance {covariance}"}
        alarms.plot(rows["day"], rows["alarms"], **look)
        flagged.plot(rows["day"], 100.0 * rows["flagged"], **look)
    alarms.set_yscale("log")
    alarms.set_ylabel("alarms per collision")
    flagged.set_ylabel("collisions that raise an alarm [%]")
    flagged.set_ylim(0.0, 103.0)
    for axes in (alarms, flagged):
        axes.set_xlabel("prediction duration [d]")
    (_, row), *_ = whole[whole["model"] == CHOSEN].iterrows()
    headline = f"The model selected each day: {row['alarms']:.0f} alarms per collision after {row['day']:g} d"
    add_head_and_legend(figure, headline, note, columns=2)
    return figure
