"""Table of the thermosphere's density by NRLMSIS 2.1, around the Earth over a run.

Model: Emmert et al. 2022, NRLMSIS 2.1, JGR Space Physics 127, e2022JA030896, by pymsis. Its inputs are the
F10.7 of DTM2000 and the three-hourly ap of the 57 hours before (its storm mode). It has no winds: the
atmosphere turns with the Earth.
"""

import os
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.thermosphere_grid import ALTITUDES, DENSITIES, LATITUDES, LOCAL_TIMES
from opml.environment import solar_activity, space_weather
from opml.environment.space_weather import INTERVALS, KP, ROUNDING

NAME = "NRLMSIS"  # the model's name in the settings

_AP = (0, 2, 3, 4, 5, 6, 7, 9, 12, 15, 18, 22, 27, 32, 39, 48, 56, 67, 80, 94, 111, 132, 154, 179, 207, 236)
_AP_OF_THIRDS = np.array([*_AP, 300, 400], float)
"""The ap of Kp in thirds from 0 (Bartels 1957, by GFZ Potsdam)."""

_UNIX_DAY = 40587  # modified Julian day of 1970-01-01
_RUN_UP = 20  # intervals of ap that the model needs: those of 57 hours before, and the one at the time


def sources() -> dict[str, str]:
    """Return the sources of the table's numbers, for its metadata."""
    return {
        "model": "NRLMSIS 2.1 (Emmert et al. 2022, JGR Space Physics 127, e2022JA030896)",
        "code": f"pymsis {version('pymsis')}",
    }


def check_installed() -> None:
    """Raise InputError where the model's code is missing: its terms are not opml's, so it is an extra."""
    if find_spec("pymsis") is None:
        raise InputError("expected the package pymsis, got none: pip install 'opml-orbits[nrlmsis]'")


def tabulate(source: str | Path, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the table `thermosphere`: densities [kg/m3] at each node of the grid.

    source: OBSERVED or a CSSI file

    Raises InputError where the source is unreadable, holds monthly figures or does not cover the times.
    """
    figures = read_weather(source, epoch, t)
    parts = map(_rows_at_time, t, clocks(epoch, t), figures)
    return pd.concat(parts, ignore_index=True)


def read_weather(source: str | Path, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return F10.7, its 81-day mean [sfu] and seven ap, the model's inputs, at times `t`: (n, 9).

    The ap are the mean of the day before; those of the interval and of 3, 6 and 9 hours before; and the means
    of 12 to 33 and of 36 to 57 hours before. Parameters and errors are those of `tabulate`.
    """
    path = solar_activity.resolve(source)
    text = solar_activity.read_text(path)
    if not space_weather.is_space_weather(text):
        raise InputError(f"{source}: expected weather that was measured day by day, OBSERVED or a CSSI file")
    flux = space_weather.tabulate(path, text, epoch, t)[["f107", "f107_mean"]].to_numpy()
    days = space_weather.read(path, text)
    elapsed = space_weather.days(epoch, t) - days.index[0]
    interval = np.floor(INTERVALS * (elapsed + ROUNDING)).astype(int)
    if interval.min() < _RUN_UP:
        raise InputError(f"{path.name}: epoch: expected three days of weather before it, got fewer")
    ap = ap_of_kp(days[KP].to_numpy().ravel())
    return np.column_stack([flux, np.array([ap_inputs(ap, one) for one in interval])])


def ap_of_kp(kp: np.ndarray) -> np.ndarray:
    """Return the three-hourly ap of Kp, by Bartels's table."""
    return np.asarray(_AP_OF_THIRDS[np.round(3.0 * kp).astype(int)])


def ap_inputs(ap: np.ndarray, interval: int) -> np.ndarray:
    """Return the seven ap (7,) that the model takes in an interval of three hours, see `read_weather`."""
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
    figures: (9,) inputs as from `weather`
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


def clocks(epoch: str, t: np.ndarray) -> np.ndarray:
    """Return the days since 1970-01-01 (UTC) at times `t` [s since `epoch`]."""
    return np.asarray(space_weather.days(epoch, t) - _UNIX_DAY)


def _rows_at_time(t: float, clock: float, figures: np.ndarray) -> pd.DataFrame:
    """Return the table's rows of one time, all latitudes of each local time together."""
    local, north, altitude = (np.array(axis) for axis in (LOCAL_TIMES, LATITUDES, ALTITUDES))
    density = densities(clock, local - 2.0 * np.pi * (clock % 1.0), north, altitude, figures)
    place = {"t": t, "local_time": np.repeat(local, len(north)), "latitude": np.tile(north, len(local))}
    return pd.DataFrame(place | dict(zip(DENSITIES, density.reshape(-1, len(altitude)).T, strict=True)))
