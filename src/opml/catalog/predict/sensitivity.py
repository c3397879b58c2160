"""Sensitivity of each prediction to the drag coefficient, from neighbours of its arc.

A catalogue can compute all of this: it needs the estimates and the assumed model, not the truth.
"""

import numpy as np
import pandas as pd

from opml.catalog.predict.neighbours import propagate_neighbours
from opml.catalog.propagator import Propagator
from opml.orbits.elements import in_rsw
from opml.tables import STATE

CD_NUDGE = 0.01  # change of Cd between neighbouring arcs: small against Cd, large against rounding


def sensitivities(propagator: Propagator, estimates: pd.DataFrame, predictions: pd.DataFrame) -> pd.DataFrame:
    """Return the `sensitivities` table: for each pair of the predictions, in RSW of the predicted state.

    s_*: change of the predicted state per unit of Cd, the estimated state held. v_*: the same where the state
    moves along with Cd as the fit's own covariance has it, P_xc / P_cc. A pair without a prediction has no
    numbers.
    """
    first = np.searchsorted(estimates["track"], np.unique(predictions["i"]))
    started = estimates.iloc[first]
    predicted = predictions[STATE].to_numpy()
    states, cd = started[STATE].to_numpy(), started["cd"].to_numpy() + CD_NUDGE
    departing = np.concatenate([states, states + CD_NUDGE * shift_with_cd(started)])
    families = propagate_neighbours(propagator, predictions, started, departing, np.tile(cd, 2))
    table = {"i": predictions["i"], "j": predictions["j"]}
    for name, propagated in zip("sv", families, strict=True):
        change = (1.0 / CD_NUDGE) * in_rsw(propagated - predicted, predicted)
        table |= {f"{name}_{axis}": change[:, k] for k, axis in enumerate(STATE)}
    return pd.DataFrame(table)


def shift_with_cd(estimates: pd.DataFrame) -> np.ndarray:
    """Return the change (n, 6) of the estimated state per unit of Cd along the fit's covariance.

    It is the conditional mean of the state given Cd: what the fit would have estimated had Cd been known; 0
    where Cd was held.
    """
    shared = estimates[[f"cov_cd_{name}" for name in STATE]].to_numpy()
    variance = estimates["cov_cd_cd"].to_numpy()[:, None]
    return np.divide(shared, variance, out=np.zeros_like(shared), where=variance > 0.0)
