"""One prediction under many futures of the space weather, and what its error was."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.figures.style import MUTED, PREDICTED, TRUE, column_figure, noted

_KM = 1e-3


def chart(fans: pd.DataFrame, ensemble: pd.DataFrame, *, track: int, level: float, note: str = "") -> Figure:
    """Along-track errors [km] that the futures say, their band, and the true ones, by duration [d].

    fans, ensemble: the tables; level: of the band; track: of the estimate that the prediction starts from;
    note: whose it is. Raises InputError where no prediction starts there.
    """
    own = fans[fans["i"] == track]
    if own.empty:
        raise InputError(f"fan: expected the track of an estimate that predictions start from, got {track}")
    days = np.append(0.0, own["duration"] / DAY)
    figure, axes = column_figure(height_mm=74.0)
    for _, future in ensemble[ensemble["i"] == track].groupby("member"):
        axes.plot(days, _from_zero(-future["d_y"]), color=MUTED, lw=0.4, alpha=0.5)
    low, median, high, true = (_from_zero(own[name]) for name in ("low", "median", "high", "e_y"))
    axes.fill_between(
        days, low, high, color=PREDICTED, alpha=0.2, lw=0.0, label=f"{100.0 * level:g} % of the futures"
    )
    axes.plot(days, median, color=PREDICTED, label="their median")
    axes.plot(days, true, color=TRUE, ls="", marker="o", ms=2.2, label="true error")
    axes.set_xlabel(r"prediction duration $\Delta t$ [d]")
    axes.set_ylabel(r"along-track error $e_y$ [km]")
    noted(figure, note)
    axes.legend(loc="best")
    return figure


def _from_zero(metres: pd.Series) -> np.ndarray:
    """Values [km] behind the start of the prediction, where all is nothing."""
    found: np.ndarray = np.append(0.0, _KM * metres.to_numpy())
    return found
