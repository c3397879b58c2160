"""Density of the thermosphere as an orbit meets it, by the activity alone: what forecasts are judged by."""

import numpy as np

from opml.dynamics.kernels import dtm2000
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS
from opml.dynamics.kernels.lanes import WIDTH, entry, load, rows, splat, store

_ALTITUDE = 400e3
_INCLINATION = np.radians(51.6)
_POINTS = 3 * WIDTH
"""Points of the orbit, evenly spaced; twice as many change the mean by less than 1e-4 of it."""


class OrbitDensity:
    """Mean density along a circular orbit at 400 km, whose node is at midnight."""

    def __init__(self) -> None:
        """Take the points of the orbit and DTM2000's coefficients; the day of the year is fixed."""
        self._coefficients = dtm2000.coefficients()
        self._season = np.ascontiguousarray(dtm2000.seasons(self._coefficients, np.array([80]))[0])
        self._points = _points()

    def densities(self, activity: np.ndarray) -> np.ndarray:
        """Return densities (n,) [kg/m3]; activity: (n, 4) F10.7, its mean [sfu], Kp of 3 h, of 24 h."""
        means = np.zeros((len(activity), WIDTH))
        work = rows(dtm2000.FACTORS), rows(SCRATCH_ROWS)
        activity = np.ascontiguousarray(activity, float)
        _sum(activity, self._coefficients, self._season, self._points, means, *work)
        densities: np.ndarray = means.sum(axis=1) / _POINTS
        return densities


def _points() -> np.ndarray:
    """Return sines and cosines of latitude and of local time of the orbit's points, (blocks, 4, WIDTH)."""
    u = 2.0 * np.pi * np.arange(_POINTS) / _POINTS
    sin_lat = np.sin(_INCLINATION) * np.sin(u)
    time = np.arctan2(np.cos(_INCLINATION) * np.sin(u), np.cos(u))
    columns = np.stack([sin_lat, np.sqrt(1.0 - sin_lat**2), np.sin(time), np.cos(time)])
    return np.ascontiguousarray(columns.reshape(4, -1, WIDTH).transpose(1, 0, 2))


@entry
def _sum(activity, a, season, points, sums, factors, basis):
    """Fill `sums` (n, WIDTH) with the densities at the points, lane by lane; longitude is local time."""
    for n in range(activity.shape[0]):
        dtm2000.reduce_to_date(
            a, season, activity[n, 0], activity[n, 1], activity[n, 2], activity[n, 3], factors
        )
        total = splat(0.0)
        for k in range(points.shape[0]):
            p = points[k]
            sin_time, cos_time = load(p, 2), load(p, 3)
            total = total + dtm2000.density(
                splat(_ALTITUDE),
                load(p, 0),
                load(p, 1),
                sin_time,
                cos_time,
                sin_time,
                cos_time,
                a,
                factors,
                basis,
            )
        store(sums, n, total)
