"""Covariances of predictions: that of the fit, carried along by neighbours of its arc."""

import numpy as np
import pandas as pd

from opml.catalog.estimation import COVARIANCES, NUDGES
from opml.catalog.flying import fly_pairs
from opml.dynamics.ensemble import Integrator
from opml.dynamics.surroundings import ForceModel
from opml.elements import in_rsw
from opml.sheets import Rso
from opml.tables import PARAMETERS, STATE

_PARAMETERS = len(PARAMETERS)


def propagated(
    model: ForceModel,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    rso: Rso,
    *,
    integrator: Integrator,
    threads: int = 1,
) -> np.ndarray:
    """Formal covariances (n, 6, 6) of predictions in RSW of the predicted state [m, m/s].

    The fit's covariance of state and Cd, F P F' with F the differences of arcs that begin beside the
    estimate's. model, estimates, predictions, rso: as in `sensitivity.sensitivities`. Not finite where a
    neighbour does not reach.
    """
    tracks, arc = np.unique(predictions["i"], return_inverse=True)
    started = estimates.set_index("track").loc[tracks]
    predicted = predictions[STATE].to_numpy()
    change = np.empty((len(predictions), 6, _PARAMETERS))
    for k, nudge in enumerate(np.diag(NUDGES)):
        flown, _ = fly_pairs(
            model,
            rso,
            predictions,
            started[STATE].to_numpy() + nudge[:6],
            cd=started["cd"].to_numpy() + nudge[6],
            integrator=integrator,
            threads=threads,
        )
        change[:, :, k] = in_rsw(flown - predicted, predicted) / NUDGES[k]
    formal: np.ndarray = change @ fitted(started)[arc] @ change.transpose(0, 2, 1)
    symmetric: np.ndarray = 0.5 * (formal + formal.transpose(0, 2, 1))
    return symmetric


def fitted(estimates: pd.DataFrame) -> np.ndarray:
    """Covariances (n, 7, 7) of state and Cd, GCRF, of rows of `estimates`."""
    row, column = np.tril_indices(_PARAMETERS)
    covariance = np.empty((len(estimates), _PARAMETERS, _PARAMETERS))
    covariance[:, row, column] = covariance[:, column, row] = estimates[COVARIANCES]
    return covariance


def stretched(formal: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Covariances (n, 6, 6) of the shape of `formal` ones (n, 6, 6) with positions known to `sigma` (n, 3).

    All in RSW [m, m/s]. Correlations stay. A velocity is stretched as the position that it goes with on a
    nearly circular orbit: radial as along-track (e_vx = -w e_y), along-track as radial, and
    cross-track as cross-track.
    """
    stretch = sigma / np.sqrt(formal[:, range(3), range(3)])
    both = np.concatenate([stretch, stretch[:, [1, 0, 2]]], axis=1)
    covariance: np.ndarray = both[:, :, None] * formal * both[:, None, :]
    return covariance
