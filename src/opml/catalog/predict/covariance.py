"""The fit's own covariance, carried along by neighbours of its arc as the assumed model has it, and no more.

It is what a catalogue states at t_i without a truth: noise of the measurements through the fit, and no error
of the force model.
"""

import numpy as np
import pandas as pd

from opml.catalog.fit.neighbour_arcs import NUDGES
from opml.catalog.predict.neighbours import Neighbours
from opml.catalog.propagator import Propagator
from opml.orbits.elements import in_rsw
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, POSITION_COVARIANCES, STATE, symmetric_matrices


def of_positions(predictions: pd.DataFrame, carried: np.ndarray) -> pd.DataFrame:
    """Return the `covariances` table: that of the position, for each pair of the predictions.

    carried: (n, 6, 6) from `propagated`
    """
    row, column = np.tril_indices(3)
    table = {"i": predictions["i"].to_numpy(), "j": predictions["j"].to_numpy()}
    return pd.DataFrame(table | dict(zip(POSITION_COVARIANCES, carried[:, row, column].T, strict=True)))


def propagated(propagator: Propagator, estimates: pd.DataFrame, predictions: pd.DataFrame) -> np.ndarray:
    """Return formal covariances (n, 6, 6) of predictions in RSW of the predicted state [m, m/s].

    The fit's covariance P of state and Cd becomes F P F', with F the differences of seven arcs that begin
    in addition to the estimate's, one per parameter. It is not finite where a neighbour does not reach.
    """
    tracks, arc = np.unique(predictions["i"], return_inverse=True)
    started = estimates.set_index("track").loc[tracks]
    predicted = predictions[STATE].to_numpy()
    neighbours = Neighbours.of_predictions(propagator, predictions, started)
    change = np.empty((len(predictions), len(STATE), len(PARAMETERS)))
    for k, step in enumerate(np.diag(NUDGES)):
        states, cd = started[STATE].to_numpy() + step[:6], started["cd"].to_numpy() + step[6]
        propagated = neighbours.part(k, len(PARAMETERS)).propagate(states, cd)
        change[:, :, k] = in_rsw(propagated - predicted, predicted) / NUDGES[k]
    fitted = symmetric_matrices(started, PARAMETER_COVARIANCES)[arc]
    formal: np.ndarray = change @ fitted @ change.transpose(0, 2, 1)
    return 0.5 * (formal + formal.transpose(0, 2, 1))
