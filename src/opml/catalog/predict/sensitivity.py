"""Sensitivity of each prediction to the drag coefficient, from neighbours of its arc.

A catalogue can compute all of this: it needs the estimates and the assumed model, not the truth.
"""

import numpy as np
import pandas as pd

from opml.catalog.predict.neighbours import Neighbours
from opml.catalog.propagator import Propagator
from opml.orbits.elements import in_rsw
from opml.tables import STATE

CD_NUDGE = 0.01  # change of Cd between neighbouring arcs: small against Cd, large against rounding


def sensitivities(
    propagator: Propagator,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    *,
    bounds: tuple[float, float] | None,
) -> pd.DataFrame:
    """Return the `sensitivities` table: for each pair of the predictions, in RSW of the predicted state.

    bounds: on the Cd that the running mean takes; None where it takes any

    s_*: change of the predicted state per unit of Cd, the estimated state held. v_*: the same where the state
    moves along with Cd as the fit's own covariance has it, P_xc / P_cc. r_*: the prediction less a prediction
    with the running mean of all Cd estimated so far, which is in cd_mean. A pair without a prediction has no
    numbers.
    """
    tracks, arc = np.unique(predictions["i"], return_inverse=True)
    first = np.searchsorted(estimates["track"], tracks)
    started = estimates.iloc[first]
    mean = running_mean(estimates, bounds)[first]
    predicted = predictions[STATE].to_numpy()
    table = {"i": predictions["i"], "j": predictions["j"], "cd_mean": mean[arc]}
    neighbours = Neighbours.of_predictions(propagator, predictions, started)
    for turn, (name, (states, cd)) in enumerate(_perturbed(started).items()):
        change = (1.0 / CD_NUDGE) * in_rsw(
            neighbours.part(turn, 3).propagate(states, cd) - predicted, predicted
        )
        table |= {f"{name}_{axis}": change[:, k] for k, axis in enumerate(STATE)}
    # The running mean may be far from the estimate's own Cd, so these arcs need the whole field.
    propagated, _ = propagator.part(2, 3).propagate_pairs(predictions, started[STATE].to_numpy(), cd=mean)
    change = -in_rsw(propagated - predicted, predicted)
    return pd.DataFrame(table | {f"r_{axis}": change[:, k] for k, axis in enumerate(STATE)})


def _perturbed(started: pd.DataFrame) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return (states, Cd) of arcs with another Cd than the estimates', by family of columns."""
    states, cd = started[STATE].to_numpy(), started["cd"].to_numpy() + CD_NUDGE
    return {"s": (states, cd), "v": (states + CD_NUDGE * shift_with_cd(started), cd)}


def running_mean(estimates: pd.DataFrame, bounds: tuple[float, float] | None) -> np.ndarray:
    """Return the mean of the Cd of all usable estimates up to each (n,); its own where there was none.

    Without bounds, wild values of fits that tell little of Cd count, too: the weights are then 1/variance.
    """
    cd, use = estimates["cd"].to_numpy(), usable(estimates, bounds)
    if bounds is None:
        variance = estimates["cov_cd_cd"].to_numpy()
        weight = np.divide(1.0, variance, out=np.zeros_like(variance), where=use & (variance > 0.0))
    else:
        weight = use.astype(float)
    count, total = np.cumsum(weight), np.cumsum(np.where(use, weight * cd, 0.0))
    return np.divide(total, count, out=cd.copy(), where=count > 0.0)


def usable(estimates: pd.DataFrame, bounds: tuple[float, float] | None) -> np.ndarray:
    """Return which estimates (n,) converged with their Cd within `bounds`, None for any Cd."""
    low, high = bounds or (-np.inf, np.inf)
    return np.asarray(estimates["converged"] & estimates["cd"].between(low, high))


def shift_with_cd(estimates: pd.DataFrame) -> np.ndarray:
    """Return the change (n, 6) of the estimated state per unit of Cd along the fit's covariance.

    It is the conditional mean of the state given Cd: what the fit would have estimated had Cd been known; 0
    where Cd was held.
    """
    shared = estimates[[f"cov_cd_{name}" for name in STATE]].to_numpy()
    variance = estimates["cov_cd_cd"].to_numpy()[:, None]
    return np.divide(shared, variance, out=np.zeros_like(shared), where=variance > 0.0)
