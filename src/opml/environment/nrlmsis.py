"""Density of the thermosphere by NRLMSIS 2.1.

Model: Emmert et al. 2022, NRLMSIS 2.1, JGR Space Physics 127, e2022JA030896, by pymsis. Its inputs are F10.7,
its mean, and the three-hourly ap of the 57 hours before (its storm mode).
"""

import os
from importlib.util import find_spec

import numpy as np

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.environment.space_weather import INTERVALS

_AP = (0, 2, 3, 4, 5, 6, 7, 9, 12, 15, 18, 22, 27, 32, 39, 48, 56, 67, 80, 94, 111, 132, 154, 179, 207, 236)
_AP_OF_THIRDS = np.array([*_AP, 300, 400], float)
"""The ap of Kp in thirds from 0 (Bartels 1957, by GFZ Potsdam)."""

_RUN_UP = 20  # intervals of ap that the model needs: those of 57 hours before, and the one at the time


def check_installed() -> None:
    """Raise InputError where the model's code is missing: its terms are not opml's, so it is an extra."""
    if find_spec("pymsis") is None:
        raise InputError("expected the package pymsis, got none: pip install 'opml-orbits[nrlmsis]'")


def ap_of_kp(kp: np.ndarray) -> np.ndarray:
    """Return the three-hourly ap of Kp, by Bartels's table."""
    return np.asarray(_AP_OF_THIRDS[np.round(3.0 * kp).astype(int)])


def ap_inputs(ap: np.ndarray, interval: int) -> np.ndarray:
    """Return the seven ap (7,) that the model takes in an interval of three hours.

    They are the mean of the day before; those of the interval and of 3, 6 and 9 hours before; and the means
    of 12 to 33 and of 36 to 57 hours before.
    """
    newest = ap[interval - _RUN_UP + 1 : interval + 1][::-1]
    means = [newest[begin : begin + INTERVALS].mean() for begin in (0, 4, 12)]
    return np.array([means[0], *newest[:4], *means[1:]])


def densities(
    clock: float, east: np.ndarray, north: np.ndarray, altitude: np.ndarray, figures: np.ndarray
) -> np.ndarray:
    """Return the densities [kg/m3] on a grid: (longitudes, latitudes, altitudes).

    clock: days since 1970-01-01 (UTC)
    east, north: longitudes and latitudes [rad] (WGS84)
    altitude: altitudes [m] (WGS84)
    figures: (9,) F10.7, its 81-day mean [sfu], and seven ap of `ap_inputs`
    """
    import pymsis

    # Its compiled code takes letters beyond ASCII in the path of its parameters as bytes alone.
    pymsis.msis._MSIS_PARAMETER_PATH = os.fsencode(pymsis.msis._MSIS_PARAMETER_PATH)
    moment = np.datetime64(round(clock * DAY * 1e3), "ms")
    flux, mean, *ap = figures
    output = pymsis.calculate(
        [moment],
        np.degrees(east) % 360.0,
        np.degrees(north),
        altitude / 1e3,
        [flux],
        [mean],
        [ap],
        version=2.1,
        geomagnetic_activity=-1,
    )
    return np.asarray(output[0, ..., pymsis.Variable.MASS_DENSITY].astype(float))
