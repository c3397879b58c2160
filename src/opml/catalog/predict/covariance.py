"""The fit's own covariance, carried along by neighbours of its arc as the assumed model has it, and no more.

It is what a catalogue states at t_i without a truth: noise of the measurements through the fit, and no error
of the force model.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from opml.catalog.fit.estimation import COVARIANCES, NUDGES
from opml.catalog.flight import fly_pairs, part_of
from opml.dynamics.ensemble import Integrator
from opml.dynamics.kernels.surroundings import ForceModel
from opml.orbits.elements import in_rsw
from opml.orbits.sheets import Rso
from opml.tables import PARAMETERS, POSITION_COVARIANCES, STATE, symmetric_matrices


def of_positions(predictions: pd.DataFrame, carried: np.ndarray) -> pd.DataFrame:
    """The `covariances` table: of the positions, for each pair of the predictions, from `propagated`."""
    row, column = np.tril_indices(3)
    table = {"i": predictions["i"].to_numpy(), "j": predictions["j"].to_numpy()}
    return pd.DataFrame(table | dict(zip(POSITION_COVARIANCES, carried[:, row, column].T, strict=True)))


def propagated(
    model: ForceModel,
    estimates: pd.DataFrame,
    predictions: pd.DataFrame,
    rso: Rso,
    *,
    integrator: Integrator,
    threads: int = 1,
    progress: Callable[[float], None] | None = None,
) -> np.ndarray:
    """Formal covariances (n, 6, 6) of predictions in RSW of the predicted state [m, m/s].

    The fit's covariance of state and Cd, F P F' with F the differences of seven arcs that begin beside the
    estimate's, one per parameter. model: the assumed one; estimates, predictions: the tables; rso: whose
    area, mass and Cr the arcs have. Not finite where a neighbour does not reach.
    """
    tracks, arc = np.unique(predictions["i"], return_inverse=True)
    started = estimates.set_index("track").loc[tracks]
    predicted = predictions[STATE].to_numpy()
    change = np.empty((len(predictions), len(STATE), len(PARAMETERS)))
    for k, nudge in enumerate(np.diag(NUDGES)):
        flown, _ = fly_pairs(
            model,
            rso,
            predictions,
            started[STATE].to_numpy() + nudge[:6],
            cd=started["cd"].to_numpy() + nudge[6],
            integrator=integrator,
            threads=threads,
            progress=part_of(progress, k, len(PARAMETERS)),
        )
        change[:, :, k] = in_rsw(flown - predicted, predicted) / NUDGES[k]
    formal: np.ndarray = change @ symmetric_matrices(started, COVARIANCES)[arc] @ change.transpose(0, 2, 1)
    even: np.ndarray = 0.5 * (formal + formal.transpose(0, 2, 1))
    return even
