"""One prediction under many futures of the space weather, and what its error was."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.style import MUTED, PREDICTED_COLOR, TRUE_COLOR, add_note, column_figure

_KM = 1e-3


def chart(fans: pd.DataFrame, ensemble: pd.DataFrame, *, track: int, level: float, note: str = "") -> Figure:
    """Draw the along-track errors [km] of the futures, their band, and the true errors, by duration [d].

    Raises InputError where no prediction starts from the track.

    fans: `fan` table
    ensemble: that table
    track: of the estimate that the prediction starts from
    level: share of the futures in the band
    """
    fan = fans[fans["i"] == track]
    if fan.empty:
        raise InputError(f"fan: expected the track of an estimate that predictions start from, got {track}")
    days = np.append(0.0, fan["duration"] / DAY)
    figure, axes = column_figure(height_mm=74.0)
    for _, future in ensemble[ensemble["i"] == track].groupby("member"):
        axes.plot(days, _start_at_zero(-future["d_y"]), color=MUTED, lw=0.4, alpha=0.5)
    low, median, high, true = (_start_at_zero(fan[name]) for name in ("low", "median", "high", "e_y"))
    axes.fill_between(
        days, low, high, color=PREDICTED_COLOR, alpha=0.2, lw=0.0, label=f"{100.0 * level:g} % of the futures"
    )
    axes.plot(days, median, color=PREDICTED_COLOR, label="their median")
    axes.plot(days, true, color=TRUE_COLOR, ls="", marker="o", ms=2.2, label="true error")
    axes.set_xlabel(r"prediction duration $\Delta t$ [d]")
    axes.set_ylabel(r"along-track error $e_y$ [km]")
    add_note(figure, note)
    axes.legend(loc="best")
    return figure


def _start_at_zero(errors: pd.Series) -> np.ndarray:
    """Return errors (n,) [m] in km behind the start of the prediction, where they are zero, (n + 1,)."""
    return np.append(0.0, _KM * errors.to_numpy())
