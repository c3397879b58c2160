"""What a radar station measures of an RSO: azimuth, elevation and range.

Measurements are geometric, without light time or aberration. Only a fit may read them as received at their
time, after the light's way down (`retarded`).
"""

import erfa
import numpy as np

from opml.base.constants import SPEED_OF_LIGHT
from opml.orbits.elements import wrap_turn
from opml.orbits.sheets import Station

_WGS84 = 1


def site(station: Station) -> tuple[np.ndarray, np.ndarray]:
    """Return (position in ITRF [m] (3,), rotation ITRF to east, north, up (3, 3)) of a station on WGS84."""
    lon, lat = station.longitude, station.latitude
    position = np.array(erfa.gd2gc(_WGS84, lon, lat, station.altitude))
    east = [-np.sin(lon), np.cos(lon), 0.0]
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    up = [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
    return position, np.array([east, north, up])


def sigmas(station: Station) -> np.ndarray:
    """Return the standard deviations (3,) of a station's noise, in the order of `observe` [rad, rad, m]."""
    return np.array([station.sigma_azimuth, station.sigma_elevation, station.sigma_range])


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


def retarded(positions: np.ndarray, velocities: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Return the positions (..., 3) in ITRF [m] where the light left that a station receives now.

    positions: (..., 3) ITRF now [m]
    velocities: (..., 3) inertial velocities now [m/s], in the axes of ITRF
    position: as for `observe`

    To the first order in the light's travel time, within millimetres of a low orbit (Montenbruck & Gill 2000,
    sec. 6.2).
    """
    travel = np.linalg.norm(positions - position, axis=-1, keepdims=True) / SPEED_OF_LIGHT
    left: np.ndarray = positions - travel * velocities
    return left


def place(measured: np.ndarray, position: np.ndarray, to_horizon: np.ndarray) -> np.ndarray:
    """Return positions (..., 3) in ITRF [m] from measurements (..., 3) [rad, rad, m] as of `observe`."""
    azimuth, elevation, distance = np.moveaxis(measured, -1, 0)
    level = distance * np.cos(elevation)
    local = [level * np.sin(azimuth), level * np.cos(azimuth), distance * np.sin(elevation)]
    positions: np.ndarray = position + np.einsum("...ij,...i->...j", to_horizon, np.stack(local, axis=-1))
    return positions
