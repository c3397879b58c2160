"""Predictions from every estimate to every later track, and their true errors."""

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.propagator import Propagator
from opml.catalog.simulate.truth import interpolate
from opml.dynamics.ensemble import REASONS
from opml.orbits.elements import in_rsw
from opml.tables import COMPONENTS, STATE, state_rows

TRUE = [f"{name}_true" for name in STATE]


def predict_all(
    propagator: Propagator, truth: pd.DataFrame | None, estimates: pd.DataFrame, *, max_days: float
) -> pd.DataFrame:
    """Return the `predictions` table: every pair of an estimate t_i and a later track start t_j.

    truth: the table; None where there is none, as of measured tracks: true states and errors are NaN then
    max_days: t_j is at most so long after t_i

    The true error is the predicted state less the true state, in RSW of the true state (paper, sec. Orbit
    Prediction and Machine Learning Model of the Prediction Error). A pair that the arc does not reach has no
    numbers, but the reason.
    """
    pairs = predict(propagator, estimates, arrivals=estimates.set_index("track")["t"], max_days=max_days)
    true = _true_states(truth, pairs["t_j"])
    # Row by row in memory, as sums of other layouts round differently.
    errors = in_rsw(state_rows(pairs) - true, true)
    return pairs.assign(
        **dict(zip(TRUE, true.T, strict=True)), **dict(zip(COMPONENTS, errors.T, strict=True))
    )


def _true_states(truth: pd.DataFrame | None, t: pd.Series) -> np.ndarray:
    """Return true states (n, 6) at times t (n,) [s], NaN where there is no truth."""
    if truth is None:
        return np.full((len(t), 6), np.nan)
    if not t.isin(truth["t"]).all():
        return interpolate(truth, t.to_numpy())
    return np.ascontiguousarray(truth.set_index("t")[STATE].loc[t])


def predict(
    propagator: Propagator, estimates: pd.DataFrame, *, arrivals: pd.Series, max_days: float
) -> pd.DataFrame:
    """Return the columns of `predictions` that need no truth: i, j, t_i, t_j, the state at t_j, the reason.

    propagator, estimates, max_days: as in `predict_all`
    arrivals: epochs to predict to [s], ascending, by their numbers j in the table
    """
    return predict_pairs(propagator, estimates, _pairs(estimates, arrivals, max_days))


def predict_pairs(propagator: Propagator, estimates: pd.DataFrame, pairs: pd.DataFrame) -> pd.DataFrame:
    """Return what `predict` does, of pairs: i, j, t_i and t_j in the order of i."""
    started = estimates.set_index("track").loc[np.unique(pairs["i"])]
    states, status = propagator.propagate_pairs(pairs, started[STATE].to_numpy(), cd=started["cd"].to_numpy())
    reason = np.where(np.isfinite(states[:, 0]), "", np.array(REASONS, object)[status])
    return pairs.assign(**dict(zip(STATE, states.T, strict=True)), reason=reason)


def _pairs(estimates: pd.DataFrame, arrivals: pd.Series, max_days: float) -> pd.DataFrame:
    """Return each estimate with every arrival after it, up to max_days."""
    t, ends = estimates["t"].to_numpy(), arrivals.to_numpy()
    first, end = (np.searchsorted(ends, reach, side="right") for reach in (t, t + max_days * DAY))
    i = np.repeat(np.arange(len(t)), end - first)
    j = np.concatenate([np.arange(a, b) for a, b in zip(first, end, strict=True)])
    track = estimates["track"].to_numpy()
    return pd.DataFrame({"i": track[i], "j": arrivals.index.to_numpy()[j], "t_i": t[i], "t_j": ends[j]})
