"""Typical errors of SGP4 from an element set, without other knowledge of the object.

Along each axis of RSW the variance is a^2 + (b t)^2 + (c d)^2: t is the time from the epoch, d how far the
set's own drag has carried the object by then. By quantile regression on sets of half of some 2 300 objects,
a, b and c are such that nine tenths of the errors at later sets lie inside 1.645 sigma, height by height
(`python -m validation.set_errors`). The error by drag is the density's for the most part, and so it is common
to all objects, whatever their planes.
"""

from collections.abc import Callable
from functools import cache
from importlib import resources

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base.constants import DAY
from opml.interop.element_sets.element_set import mean_height, perturb_drag, propagate
from opml.orbits.density_error import DensityErrors, drag_sensitivities
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import ErrorModel, position_covariances, rates

AXES = "rsw"

HEIGHTS = 1e3 * np.array([300.0, 400.0, 450.0, 500.0, 550.0, 600.0, 700.0, 850.0, 1000.0])
"""Edges of the bands of mean height [m] that errors were learned in."""

LONGEST = 10.0
"""Time from the epoch [d] beyond which nothing is stated: seven days and a half were learned from."""

UNSEEN = np.array([100.0, 500.0, 160.0])
"""Systematic errors of sets [m] in RSW, common to all: by orbits of Sentinel-3A and Jason-3."""

COMMON = 0.75
"""Share of the variance by drag that objects have in common, by pairs of objects on the same days."""

_MOST_ECCENTRICITY = 0.02
_MINUTES = 1440.0  # in a day
_STEP = 0.05  # part of B* by which it is changed to see what drag does


def error_model(satellite: Satrec, epoch: float, sigmas: Callable[[np.ndarray], np.ndarray]) -> ErrorModel:
    """Return the errors of what is predicted from a set.

    epoch: of the set [s]; sigmas: returns standard deviations (n, 3) in RSW [m] at times (n,) [s]

    Where errors of such orbits were learned the density has a part of them.
    """

    def density(t: np.ndarray, states: np.ndarray) -> DensityErrors | None:
        if not are_known(satellite):
            return None
        uncertainty = float(np.sqrt(COMMON) * _numbers(satellite)[1, 2])
        most = np.sqrt(COMMON) * sigmas(t)[:, 1] / uncertainty
        displacements = np.clip(drag_displacement(satellite, np.abs(t - epoch) / DAY), -most, most)
        return DensityErrors(uncertainty, t, drag_sensitivities(displacements, rates(states)))

    return ErrorModel(lambda t, states: position_covariances(sigmas(t), states), density)


def usual(satellite: Satrec, epoch: float) -> ErrorModel:
    """Return the errors of SGP4 from a set, compared with the truth; epoch: of the set [s]."""
    return error_model(satellite, epoch, lambda t: expected(satellite, np.abs(t - epoch) / DAY))


def are_known(satellite: Satrec) -> bool:
    """Return whether errors of such orbits were learned: nearly round ones from 300 to 1000 km."""
    is_near = HEIGHTS[0] <= mean_height(satellite.no_kozai) < HEIGHTS[-1]
    return bool(is_near and satellite.ecco < _MOST_ECCENTRICITY)


def usual_sigmas(satellite: Satrec, days: np.ndarray) -> np.ndarray:
    """Return standard deviations (n, 3) in RSW [m] of what SGP4 makes of a set, compared with later ones.

    days: (n,) times from the epoch

    Orbits lower or higher than any that was learned from err as the nearest.
    """
    grown = np.stack([np.ones_like(days), days, drag_displacement(satellite, days)])
    return np.asarray(np.sqrt(_numbers(satellite) ** 2 @ grown**2).T)


def expected(satellite: Satrec, days: np.ndarray) -> np.ndarray:
    """Return standard deviations (n, 3) in RSW [m] of what SGP4 makes of a set, compared with the truth."""
    return np.asarray(np.hypot(usual_sigmas(satellite, days), UNSEEN))


def drag_displacement(satellite: Satrec, days: np.ndarray) -> np.ndarray:
    """Return how far a set's drag carries an object along its track by SGP4 (n,) [m]; 0 where that fails."""
    propagated, perturbed = (sgp4_states(one, days) for one in (satellite, perturb_drag(satellite, _STEP)))
    return np.asarray(np.nan_to_num(bent_rsw(perturbed[:, :3], propagated)[:, 1] / _STEP))


def sgp4_states(satellite: Satrec, days: np.ndarray) -> np.ndarray:
    """Return SGP4's states (n, 6) in TEME [m, m/s] after times (n,), positions NaN where it fails."""
    return np.asarray(1e3 * np.hstack(propagate(satellite, _MINUTES * days)))


def _numbers(satellite: Satrec) -> np.ndarray:
    """Return a [m], b [m/d] and c (3 axes, 3) of the height nearest to a set's."""
    band = int(np.searchsorted(HEIGHTS, mean_height(satellite.no_kozai), side="right")) - 1
    return np.asarray(law()[min(max(band, 0), len(HEIGHTS) - 2)])


@cache
def law() -> np.ndarray:
    """Return a [m], b [m/d] and c (bands, 3 axes, 3)."""
    with resources.files("opml.data").joinpath("set_errors.csv").open(encoding="ascii") as file:
        table = pd.read_csv(file, comment="#")
    numbers = table[["constant_m", "rate_m_per_d", "drag"]].to_numpy(float)
    return np.asarray(numbers.reshape(len(HEIGHTS) - 1, len(AXES), 3))
