"""How each prediction answers to the drag coefficient, from neighbours of its arc.

A catalogue can compute all of this: it needs the estimates and the assumed model, not the truth.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from opml.catalog.flight import fly_pairs, part_of
from opml.dynamics.ensemble import Integrator
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import in_rsw
from opml.orbits.sheets import Rso
from opml.tables import STATE

_NUDGE = 0.01
"""Change of Cd between neighbouring arcs: small against Cd, large against rounding."""


def sensitivities(
    model: ForceModel,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    rso: Rso,
    *,
    bounds: tuple[float, float] | None,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> pd.DataFrame:
    """The `sensitivities` table: for each pair of the predictions, in RSW of the predicted state.

    s_*: change of the predicted state per unit of Cd, the estimated state held. v_*: the same where
    the state moves along with Cd as the fit's own covariance has it, P_xc / P_cc. r_*: the
    prediction less the one made again with the running mean of all Cd estimated so far within
    `bounds` (all of them where it is None), which is in cd_mean. A pair without a prediction has no numbers.
    model: the assumed one; estimates, predictions: the tables; rso: whose area, mass and Cr the arcs have.
    """
    tracks, arc = np.unique(predictions["i"], return_inverse=True)
    first = np.searchsorted(estimates["track"], tracks)
    started = estimates.iloc[first]
    mean = running_mean(estimates, bounds)[first]
    predicted = predictions[STATE].to_numpy()
    table = {"i": predictions["i"], "j": predictions["j"], "cd_mean": mean[arc]}
    neighbours = _neighbours(started, mean)
    for turn, (name, (states, cd, scale)) in enumerate(neighbours.items()):
        flown, _ = fly_pairs(
            model,
            rso,
            predictions,
            states,
            cd=cd,
            integrator=integrator,
            threads=threads,
            progress=part_of(progress, turn, len(neighbours)),
        )
        change = scale * in_rsw(flown - predicted, predicted)
        table |= {f"{name}_{axis}": change[:, k] for k, axis in enumerate(STATE)}
    return pd.DataFrame(table)


def _neighbours(started: pd.DataFrame, mean: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray, float]]:
    """(states, Cd, scale of the change) of the arcs beside those of the estimates, by family of columns."""
    states, cd = started[STATE].to_numpy(), started["cd"].to_numpy()
    return {
        "s": (states, cd + _NUDGE, 1.0 / _NUDGE),
        "v": (states + _NUDGE * shift_with_cd(started), cd + _NUDGE, 1.0 / _NUDGE),
        "r": (states, mean, -1.0),
    }


def running_mean(estimates: pd.DataFrame, bounds: tuple[float, float] | None) -> np.ndarray:
    """Mean of the Cd of all usable estimates up to and with each one; its own where there was none.

    Without bounds, wild values of fits that tell little of Cd count, too: the weights are then 1/variance.
    """
    cd, use = estimates["cd"].to_numpy(), usable(estimates, bounds)
    if bounds is None:
        variance = estimates["cov_cd_cd"].to_numpy()
        weight = np.divide(1.0, variance, out=np.zeros_like(variance), where=use & (variance > 0.0))
    else:
        weight = use.astype(float)
    count, total = np.cumsum(weight), np.cumsum(np.where(use, weight * cd, 0.0))
    mean: np.ndarray = np.divide(total, count, out=cd.copy(), where=count > 0.0)
    return mean


def usable(estimates: pd.DataFrame, bounds: tuple[float, float] | None) -> np.ndarray:
    """Which estimates converged with their Cd within `bounds`, if any are given (bool, one per estimate)."""
    low, high = bounds or (-np.inf, np.inf)
    return np.asarray(estimates["converged"] & estimates["cd"].between(low, high))


def shift_with_cd(estimates: pd.DataFrame) -> np.ndarray:
    """Change of the estimated state per unit of Cd along the fit's covariance, (n, 6); 0 where Cd was held.

    It is what the fit would have found for the state had Cd been given: the conditional mean of
    the state given Cd.
    """
    shared = estimates[[f"cov_cd_{name}" for name in STATE]].to_numpy()
    own = estimates["cov_cd_cd"].to_numpy()[:, None]
    shift: np.ndarray = np.divide(shared, own, out=np.zeros_like(shared), where=own > 0.0)
    return shift
