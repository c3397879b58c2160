"""Passes of a predicted object over a place, and how many seconds early or late they may be."""

from collections.abc import Iterator
from dataclasses import dataclass

import erfa
import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.catalog.simulate.observing import horizon, observe
from opml.dynamics.frames import gcrf_to_itrf
from opml.environment import earth_orientation, nodes
from opml.interop import ccsds
from opml.interop.predicted_orbit import PredictedOrbit
from opml.orbits.rsw_covariance import half_width

LOWEST = np.radians(5.0)  # elevation above which an object passes [rad]
LEVEL = 0.9  # share of passes that are no earlier or later than told
_STEP = 20.0  # between looks [s]
_WGS84 = 1
_BOUNDS = ((-90.0, 90.0), (-180.0, 360.0), (-500.0, 10_000.0))


@dataclass(frozen=True)
class Place:
    """A place on WGS84 [rad, m], under the name that its user gave it."""

    name: str
    latitude: float
    longitude: float
    altitude: float


def place(text: str) -> Place:
    """Return a place of latitude, longitude [deg] and altitude [m], as 52.2,21.0,110.

    Raises InputError for another text.
    """
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    numbers += [0.0] * (len(numbers) == len(_BOUNDS) - 1)
    if len(numbers) != len(_BOUNDS) or not all(
        low <= number <= high for number, (low, high) in zip(numbers, _BOUNDS, strict=True)
    ):
        raise InputError(f"--station: expected latitude,longitude,altitude as 52.2,21.0,110, got {text}")
    latitude, longitude, altitude = numbers
    return Place(text, float(np.radians(latitude)), float(np.radians(longitude)), altitude)


def in_itrf(prediction: PredictedOrbit, t: np.ndarray) -> np.ndarray:
    """Return positions (n, 3) in ITRF [m] at times (n,) [s since the date of the prediction]."""
    hours = nodes(prediction.date, DAY * prediction.days)
    turns = gcrf_to_itrf(earth_orientation.tabulate(prediction.date, hours), t)
    return np.asarray(np.einsum("nij,nj->ni", turns, prediction.states(t)[:, :3]))


def passes(prediction: PredictedOrbit, where: Place) -> pd.DataFrame:
    """Return the passes over a place: rise, highest, set (UTC texts), elevation [deg], early_or_late [s].

    A pass that is under way at the beginning or the end is left out.
    """
    t = np.arange(0.0, DAY * prediction.days, _STEP)
    elevation = _elevation(prediction, where, t)
    rows = []
    for first, last in _spans(elevation > LOWEST):
        rise, fall = (_crossing(t, elevation, k) for k in (first - 1, last - 1))
        fine = np.linspace(rise, fall, max(int(fall - rise), 2))
        heights = _elevation(prediction, where, fine)
        top = fine[int(np.argmax(heights))]
        speed = float(np.linalg.norm(prediction.states(np.array([top]))[0, 3:]))
        ahead = float(prediction.sigmas(np.array([top]))[0, 1])
        times = ccsds.utc_texts(prediction.date, np.array([rise, top, fall]))
        rows.append((*times, float(np.degrees(heights.max())), half_width(LEVEL) * ahead / speed))
    return pd.DataFrame(rows, columns=["rise", "highest", "set", "elevation", "early_or_late"])


def _elevation(prediction: PredictedOrbit, where: Place, t: np.ndarray) -> np.ndarray:
    position = _site(where)
    seen = observe(in_itrf(prediction, t), position, horizon(where.longitude, where.latitude))
    return np.asarray(seen[:, 1])


def _site(where: Place) -> np.ndarray:
    return np.array(erfa.gd2gc(_WGS84, where.longitude, where.latitude, where.altitude))


def _spans(is_up: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yield first index and the one after the last of each run of truth that begins and ends within."""
    edges = np.flatnonzero(np.diff(is_up.astype(int))) + 1
    begins = edges[is_up[edges]]
    for begin in begins:
        if len(ends := edges[edges > begin]):
            yield int(begin), int(ends[0])


def _crossing(t: np.ndarray, elevation: np.ndarray, k: int) -> float:
    """Return when the elevation crosses LOWEST between looks k and k + 1, on a straight line [s]."""
    share = (LOWEST - elevation[k]) / (elevation[k + 1] - elevation[k])
    return float(t[k] + share * (t[k + 1] - t[k]))
