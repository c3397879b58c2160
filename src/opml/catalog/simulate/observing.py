"""Measurements of an RSO by a station: angles, range and range rate.

Measurements are geometric, without light time, unless they are read as received at their time, after the
light travel time (`light_time`). Neither aberration nor refraction moves them: angles are
those of the straight line, right ascension and declination on the axes of GCRF, from the station.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import erfa
import numpy as np
import pandas as pd

from opml.base.constants import EARTH_GM, EARTH_RATE, SPEED_OF_LIGHT
from opml.dynamics.frames import gcrf_to_itrf, spin
from opml.orbits.elements import wrap_half_turn, wrap_turn
from opml.orbits.sheets import Station

_WGS84 = 1

QUANTITIES = ["azimuth", "elevation", "range"]  # what radars measure, in the order of `observe`
OBSERVABLES = [*QUANTITIES, "range_rate", "right_ascension", "declination"]  # all that a station may measure

ANGLES = [name for name in OBSERVABLES if not name.startswith("range")]

_TURNS = ("azimuth", "right_ascension")


def site(station: Station) -> tuple[np.ndarray, np.ndarray]:
    """Return (position in ITRF [m] (3,), rotation ITRF to east, north, up (3, 3)) of a station on WGS84."""
    lon, lat = station.longitude, station.latitude
    return np.array(erfa.gd2gc(_WGS84, lon, lat, station.altitude)), horizon(lon, lat)


def horizon(lon: float, lat: float) -> np.ndarray:
    """Return the rotation (3, 3) from ITRF to east, north, up at a longitude and latitude on WGS84 [rad]."""
    east = [-np.sin(lon), np.cos(lon), 0.0]
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    up = [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
    return np.array([east, north, up])


def measured_by(station: Station) -> list[str]:
    """Return the names of what a station measures, in the order of OBSERVABLES."""
    return [name for name in OBSERVABLES if f"sigma_{name}" in station.row]


def sigmas(station: Station, names: Sequence[str]) -> np.ndarray:
    """Return the standard deviations (len(names),) of a station's noise [rad, m, m/s], NaN of no noise."""
    return np.array([station.row.get(f"sigma_{name}", np.nan) for name in names])


def wrapped(values: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Return measurements (..., len(names)) with angles of a full turn in [0, 2 pi)."""
    return np.where([name in _TURNS for name in names], wrap_turn(values), values)


def difference(one: np.ndarray, other: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Return one less the other measurements (..., len(names)), those of a full turn in (-pi, pi]."""
    difference: np.ndarray = one - other
    for k, name in enumerate(names):
        if name in _TURNS:
            difference[..., k] = wrap_half_turn(difference[..., k])
    return difference


@dataclass(frozen=True)
class StationStates:
    """Positions of stations at the times of n measurements, in the axes of ITRF at each time."""

    position: np.ndarray  # (n, 3) in ITRF [m]
    velocity: np.ndarray  # (n, 3) inertial [m/s]
    to_horizon: np.ndarray  # (n, 3, 3) rotations to east, north, up
    from_gcrf: np.ndarray  # (n, 3, 3) rotations from GCRF
    two_way: np.ndarray  # (n,) whether the light went there and back

    @classmethod
    def at(
        cls,
        t: np.ndarray,
        stations: Sequence[Station],
        station_of_row: np.ndarray,
        earth_orientation: pd.DataFrame,
        *,
        two_way: np.ndarray | None = None,
    ) -> Self:
        """Return where stations stand at times t (n,) [s]; station_of_row: (n,) index of each."""
        sites = [site(station) for station in stations]
        position, to_horizon = (np.array([place[k] for place in sites])[station_of_row] for k in (0, 1))
        two_way = np.zeros(len(t), bool) if two_way is None else two_way
        return cls.of_places(t, position, to_horizon, earth_orientation, two_way=two_way)

    @classmethod
    def of_places(
        cls,
        t: np.ndarray,
        position: np.ndarray,
        to_horizon: np.ndarray,
        earth_orientation: pd.DataFrame,
        *,
        two_way: np.ndarray,
    ) -> Self:
        """Return stands of positions (n, 3) and horizons (n, 3, 3) at times t (n,) [s]."""
        from_gcrf, nodes = gcrf_to_itrf(earth_orientation, t), earth_orientation["t"].to_numpy()
        turning = np.stack([np.interp(t, nodes, axis) for axis in spin(earth_orientation).T], axis=-1)
        velocity = np.cross(np.einsum("nij,nj->ni", from_gcrf, turning), position)
        return cls(position, velocity, to_horizon, from_gcrf, two_way)

    def among(self, rows: slice | np.ndarray) -> Self:
        """Return where stations stand in rows of these measurements."""
        return type(self)(**{name: values[rows] for name, values in vars(self).items()})

    def earlier(self, travel: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return positions and inertial velocities (..., n, 3) at times (..., n) before [s]."""
        back = travel[..., None]
        inwards = -(EARTH_RATE**2) * self.position * [1.0, 1.0, 0.0]
        return self.position - back * self.velocity + 0.5 * back**2 * inwards, self.velocity - back * inwards


def observe(positions: np.ndarray, position: np.ndarray, to_horizon: np.ndarray) -> np.ndarray:
    """Return azimuth from north eastwards [0, 2 pi), elevation [rad] and range [m]: (..., 3).

    positions: (..., 3) ITRF [m]
    position, to_horizon: of one station, from `site`, or arrays of them that broadcast

    Source: Vallado 2013, sec. 4.4.3.
    """
    local = np.einsum("...ij,...j->...i", to_horizon, positions - position)
    distance = np.linalg.norm(local, axis=-1)
    azimuth = wrap_turn(np.arctan2(local[..., 0], local[..., 1]))
    elevation = np.arctan2(local[..., 2], np.hypot(local[..., 0], local[..., 1]))
    return np.stack([azimuth, elevation, distance], axis=-1)


def retarded(
    positions: np.ndarray, velocities: np.ndarray, position: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where (..., 3) in ITRF [m], and how fast, the light left that a station receives now.

    positions: (..., 3) ITRF now [m]
    velocities: (..., 3) inertial velocities now [m/s], in the axes of ITRF
    position: as for `observe`

    The third is the light's travel time (...) [s]. The downlink is bent by the Earth's central attraction, to
    micrometres (Montenbruck & Gill 2000, sec. 6.2).
    """
    fall = -EARTH_GM * positions / np.linalg.norm(positions, axis=-1, keepdims=True) ** 3
    left = positions
    for _ in range(3):
        travel = np.linalg.norm(left - position, axis=-1, keepdims=True) / SPEED_OF_LIGHT
        left = positions - travel * velocities + 0.5 * travel**2 * fall
    return left, velocities - travel * fall, travel[..., 0]


def predicted(
    names: Sequence[str],
    positions: np.ndarray,
    velocities: np.ndarray,
    stands: StationStates,
    *,
    light_time: bool = False,
) -> np.ndarray:
    """Return what stations measure of an RSO: (..., n, len(names)) of OBSERVABLES [rad, m, m/s].

    positions: (..., n, 3) in ITRF at the times of the measurements [m]
    velocities: (..., n, 3) inertial [m/s], in the axes of ITRF
    light_time: the measurements are received at their times

    A rate is the difference of the velocities, when the light leaves and when it is received, along its path;
    those there and back are the mean of both directions.
    """
    travel = None
    if light_time:
        positions, velocities, travel = retarded(positions, velocities, stands.position)
    seen = observe(positions, stands.position, stands.to_horizon)
    if travel is None and list(names) == QUANTITIES:
        return seen
    observables = dict(zip(QUANTITIES, np.moveaxis(seen, -1, 0), strict=True))
    observables["range_rate"] = _rate(positions, velocities, stands.position, stands.velocity)
    if travel is not None and stands.two_way.any():
        _go_there_and_back(observables, positions, velocities, stands, travel)
    if "declination" in names or "right_ascension" in names:
        away = np.einsum("...nij,...ni->...nj", stands.from_gcrf, positions - stands.position)
        observables["right_ascension"] = wrap_turn(np.arctan2(away[..., 1], away[..., 0]))
        observables["declination"] = np.arctan2(away[..., 2], np.hypot(away[..., 0], away[..., 1]))
    return np.stack([observables[name] for name in names], axis=-1)


def _go_there_and_back(
    values: dict[str, np.ndarray],
    positions: np.ndarray,
    velocities: np.ndarray,
    stands: StationStates,
    travel: np.ndarray,
) -> None:
    """Replace ranges and rates, where the light went up too, by the mean of both directions.

    positions, velocities: (..., n, 3) when the light came by; travel: (..., n) of its path down [s]
    """
    up = travel
    for _ in range(3):
        position, velocity = stands.earlier(travel + up)
        up = np.linalg.norm(positions - position, axis=-1) / SPEED_OF_LIGHT
    upwards = {"range": SPEED_OF_LIGHT * up, "range_rate": _rate(positions, velocities, position, velocity)}
    for name, value in upwards.items():
        values[name] = np.where(stands.two_way, 0.5 * (values[name] + value), values[name])


def _rate(
    positions: np.ndarray, velocities: np.ndarray, position: np.ndarray, velocity: np.ndarray
) -> np.ndarray:
    """Return the rate (...) [m/s] at which an RSO moves away from a station, along the line between them."""
    away = positions - position
    return np.sum(away * (velocities - velocity), axis=-1) / np.linalg.norm(away, axis=-1)


def place(measured: np.ndarray, position: np.ndarray, to_horizon: np.ndarray) -> np.ndarray:
    """Return positions (..., 3) in ITRF [m] from measurements (..., 3) [rad, rad, m] as of `observe`."""
    azimuth, elevation, distance = np.moveaxis(measured, -1, 0)
    level = distance * np.cos(elevation)
    local = [level * np.sin(azimuth), level * np.cos(azimuth), distance * np.sin(elevation)]
    return position + np.einsum("...ij,...i->...j", to_horizon, np.stack(local, axis=-1))
