"""Predictions from every estimate to every later track, and their true errors."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from opml.catalog.flying import fly
from opml.constants import DAY
from opml.dynamics.ensemble import REASONS, Integrator
from opml.dynamics.surroundings import ForceModel
from opml.elements import in_rsw
from opml.sheets import Rso
from opml.tables import COMPONENTS, STATE

TRUE = [f"{name}_true" for name in STATE]


def predict_all(
    model: ForceModel,
    truth: pd.DataFrame | None,
    estimates: pd.DataFrame,
    rso: Rso,
    *,
    max_days: float,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `predictions` table: every pair of an estimate t_i and a later track start t_j.

    model: the assumed one; t_j is at most max_days after t_i. The true error is the predicted state less the
    true one, in RSW of the true state (paper, sec. Orbit Prediction and Machine Learning Model of the
    Prediction Error). Where there is no truth, as of tracks that were measured, true states and errors are
    NaN. A pair that the arc does not reach has no numbers, but the reason.
    """
    epochs = estimates["t"].to_numpy()
    first = np.arange(len(epochs))
    last = np.searchsorted(epochs, epochs + max_days * DAY, side="right") - 1
    arcs = fly(
        model,
        rso,
        epochs,
        estimates[STATE].to_numpy(),
        cd=estimates["cd"].to_numpy(),
        first=first,
        last=last,
        integrator=integrator,
        threads=threads,
        progress=progress,
    )
    i = np.repeat(first, last - first)
    j = np.concatenate([np.arange(a + 1, b + 1) for a, b in zip(first, last, strict=True)])
    true = _true_states(truth, epochs)[j]
    reached, reasons = np.isfinite(arcs.states[:, 0]), np.array(REASONS, object)[arcs.status[i]]
    track = estimates["track"].to_numpy()
    return pd.DataFrame(
        {"i": track[i], "j": track[j], "t_i": epochs[i], "t_j": epochs[j]}
        | dict(zip(STATE, arcs.states.T, strict=True))
        | dict(zip(TRUE, true.T, strict=True))
        | dict(zip(COMPONENTS, in_rsw(arcs.states - true, true).T, strict=True))
        | {"reason": np.where(reached, "", reasons)}
    )


def _true_states(truth: pd.DataFrame | None, epochs: np.ndarray) -> np.ndarray:
    """True states (n, 6) at epochs (n,) [s], NaN where there is no truth."""
    if truth is None:
        return np.full((len(epochs), 6), np.nan)
    states: np.ndarray = truth.set_index("t")[STATE].loc[epochs].to_numpy()
    return states
