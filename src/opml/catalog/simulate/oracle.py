"""What only a simulation knows: which part of a prediction's error comes from what.

No catalogue has these numbers, and no corrector is given them. They show how low a correction could go.
"""

import numpy as np
import pandas as pd

from opml.orbits.elements import coe_from_cartesian
from opml.tables import STATE


def perfect(estimates: pd.DataFrame, truth: pd.DataFrame, *, cd: float) -> pd.DataFrame:
    """Return the `estimates` table of the same tracks with the true states and drag coefficient."""
    states = truth.set_index("t")[STATE].loc[estimates["t"]].to_numpy()
    covariance = dict.fromkeys(estimates.filter(like="cov_").columns, 0.0)
    return estimates.assign(
        **dict(zip(STATE, states.T, strict=True)),
        **covariance,
        cd=cd,
        iterations=0,
        converged=True,
        reason="",
        weighted_rms=0.0,
    )


def build(
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    perfect: pd.DataFrame,
    perfect_predictions: pd.DataFrame,
    *,
    gm: float,
) -> pd.DataFrame:
    """Return the `oracle` table: one row per pair of `predictions`, in their order.

    perfect, perfect_predictions: the estimates of the function `perfect`, and the predictions from them
    gm: of the elements [m3/s2]

    drift [m] is how far along-track the error da of the estimate's semi-major axis takes the prediction by
    t_j, -3/2 v da/a (t_j - t_i). floor_* is the error [m, m/s] of the prediction from the true state and Cd,
    in RSW of the true state: that of the assumed model alone.
    """
    pairs = pd.MultiIndex.from_frame(predictions[["i", "j"]])
    floor = perfect_predictions.set_index(["i", "j"])[[f"e_{axis}" for axis in STATE]].reindex(pairs)
    a_true, a = (_semi_major_axis(table, predictions["i"], gm) for table in (perfect, estimates))
    speed = np.linalg.norm(perfect.set_index("track").loc[predictions["i"], ["vx", "vy", "vz"]], axis=1)
    duration = (predictions["t_j"] - predictions["t_i"]).to_numpy()
    table = {"i": predictions["i"], "j": predictions["j"]}
    table["drift"] = -1.5 * speed * duration * (a - a_true) / a_true
    table |= {f"floor_{axis}": floor[f"e_{axis}"].to_numpy() for axis in STATE}
    return pd.DataFrame(table)


def _semi_major_axis(estimates: pd.DataFrame, tracks: pd.Series, gm: float) -> np.ndarray:
    states = estimates.set_index("track").loc[tracks, STATE].to_numpy()
    return coe_from_cartesian(states, gm)[:, 0]
