"""Prior knowledge of an orbit: Cd, and that it is nearly round."""

from dataclasses import dataclass

import numpy as np

from opml.catalog.fit.first.round_orbits import eccentricity
from opml.catalog.fit.least_squares import Evaluation
from opml.tables import PARAMETERS

CD = PARAMETERS.index("cd")

SCALES = np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0, 1.0])
"""A-priori uncertainty [m, m/s, -] in which the damping measures a step."""

LINEAR = 10e3  # how far a state may be moved along its covariance [m], to where it would be had Cd been known
APRIORI_SIGMA = 0.5  # uncertainty of the sheet's Cd, as a part of it


@dataclass(frozen=True)
class Apriori:
    """Pseudo-measurements of a fit, in addition to its tracks."""

    cd: float  # the RSO's own
    cd_sigma: float | None  # its standard deviation; None where nothing is known
    gm: float  # [m3/s2]
    eccentricity_sigma: float | None = None  # of the eccentricity about 0; None where nothing is known

    def added_to(self, evaluation: Evaluation, trial: np.ndarray) -> Evaluation:
        """Return an evaluation at a trial (7,) with a residual more for each number that is known."""
        if self.cd_sigma is not None:
            residual = np.array([self.cd - trial[CD]]) / self.cd_sigma
            evaluation = evaluation.and_also(residual, np.eye(len(PARAMETERS))[[CD]] / self.cd_sigma)
        if self.eccentricity_sigma is not None:
            vector, derivative = eccentricity(trial[:6], self.gm)
            weighted = np.hstack([derivative, np.zeros((3, 1))]) / self.eccentricity_sigma
            evaluation = evaluation.and_also(-vector / self.eccentricity_sigma, weighted)
        return evaluation


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
