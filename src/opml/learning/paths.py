"""What is left of a position's error once the prediction is moved along its own path by a predicted error.

A prediction that is ahead by e_y is moved back by it along its orbit, so that radial and cross-track errors
follow from the same correction. Three models, one per component, would disagree: at hundred kilometres ahead
the path has left its tangent by 700 m.
"""

import numpy as np
import pandas as pd

from opml.learning.contract import Model
from opml.tables import STATE

AXES = ("x", "y", "z")
"""Radial, along-track, cross-track."""

POSITION = [f"e_{axis}" for axis in AXES]
"""Components of the error of a position; a list, so that a DataFrame takes it as it is."""

CORRECTED = "e_y"
"""The component that a prediction is corrected in, along its path; the others follow from it."""

UNCORRECTED = "none"
"""The learner whose predictions are the catalogue's own, which the fits' covariances are about."""


def with_paths(dataset: pd.DataFrame, predictions: pd.DataFrame) -> pd.DataFrame:
    """The dataset with the path of each prediction at t_j: its `radius` [m] and `climb`.

    The climb is the radial by the transverse speed. `predictions` has every pair of the dataset.
    """
    pairs = pd.MultiIndex.from_frame(dataset[["i", "j"]])
    states = predictions.set_index(["i", "j"]).loc[pairs, STATE].to_numpy()
    position, velocity = states[:, :3], states[:, 3:]
    radial = np.sum(position * velocity, axis=1)
    momentum = np.linalg.norm(np.cross(position, velocity), axis=1)
    return dataset.assign(radius=np.linalg.norm(position, axis=1), climb=radial / momentum)


def left(model: Model, rows: pd.DataFrame) -> np.ndarray:
    """Error (n, 3) [m] of the positions that `model`, of e_y, corrects, in RSW of the true state.

    rows: of a dataset `with_paths`.
    """
    along = model.predict(rows[list(model.variables)].to_numpy())
    return moved(rows[POSITION].to_numpy(), along, rows["radius"].to_numpy(), rows["climb"].to_numpy())


def moved(errors: np.ndarray, along: np.ndarray, radius: np.ndarray, climb: np.ndarray) -> np.ndarray:
    """Errors (n, 3) [m] after the predicted positions were moved back along their paths by `along` (n,) [m].

    In RSW of the true state, before and after. radius (n,) [m] and climb (n,) are of the predicted states. To
    the second order in `along` the path is a circle that climbs: it is wrong by a metre at 100 km and an
    eccentricity of 0.001.
    """
    x, y, z = errors.T
    in_plane = np.sqrt(np.maximum(radius**2 - z**2, y**2))
    ahead = np.arcsin(np.divide(y, in_plane, out=np.zeros_like(y), where=in_plane > 0.0))
    true_radius = in_plane * np.cos(ahead) - x
    turned, new_radius = ahead - along / radius, in_plane - along * climb
    return np.stack([new_radius * np.cos(turned) - true_radius, new_radius * np.sin(turned), z], axis=1)
