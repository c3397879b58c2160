"""Prior knowledge of an orbit: Cd, and that it is nearly round."""

import numpy as np

from opml.catalog.fit.first.round_orbits import eccentricity
from opml.catalog.fit.least_squares import Evaluation
from opml.tables import PARAMETERS

CD = PARAMETERS.index("cd")

SCALES = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0, 1.0])
"""A-priori uncertainty [m, m/s, -] in which the damping measures a step."""

LINEAR = 10e3  # how far a state may be moved along its covariance [m], to where it would be had Cd been known
APRIORI_SIGMA = 0.5  # uncertainty of the sheet's Cd, as a part of it


def cd_residual(trial: np.ndarray, cd: float, sigma: float) -> Evaluation:
    """Return the residual of a trial (7,) from the RSO's own Cd, as a measurement of a standard deviation."""
    return Evaluation(np.array([cd - trial[CD]]) / sigma, np.eye(len(PARAMETERS))[[CD]] / sigma)


def eccentricity_residuals(trial: np.ndarray, gm: float, sigma: float) -> Evaluation:
    """Return the residuals of a trial (7,) from a circle, as a measurement of a standard deviation.

    gm: of the Earth [m3/s2]
    """
    vector, derivative = eccentricity(trial[:6], gm)
    return Evaluation(-vector / sigma, np.hstack([derivative, np.zeros((3, 1))]) / sigma)


def covariance_root(covariance: np.ndarray) -> np.ndarray:
    """Return the root (7, 7) of a covariance of parameters; 0 where a parameter was held."""
    scaled = covariance / np.outer(SCALES, SCALES)
    free = np.ix_(*[np.diag(scaled) > 0.0] * 2)
    root = np.zeros((7, 7))
    root[free] = np.linalg.cholesky(scaled[free])
    return SCALES[:, None] * root


def with_apriori_cd(
    parameters: np.ndarray, covariance: np.ndarray, cd: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return parameters (7,) and covariance (7, 7) of a fit that takes the body's own Cd for a measurement.

    A short fit may say nothing about Cd, but the state. None where it would move too far for a straight line.
    """
    if covariance[CD, CD] == 0.0:
        return parameters, covariance
    gain = covariance[CD] / (covariance[CD, CD] + (APRIORI_SIGMA * cd) ** 2)
    moved = gain * (cd - parameters[CD])
    if np.linalg.norm(moved[:3]) > LINEAR:
        return None
    return parameters + moved, covariance - np.outer(gain, covariance[CD])
