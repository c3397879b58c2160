"""Corrections of laser ranges: troposphere and relativity, and the tides that move a station.

Delays are one-sided, the mean of both. Source: IERS Conventions 2010, secs. 7.1.1 (tides, the first step of
degree 2), 9.1 (troposphere: Mendes & Pavlis 2004, mapping function FCULa) and 11.1 (relativity).
"""

import numpy as np

from opml.base.constants import EARTH_GM, SPEED_OF_LIGHT, WGS84_A

_CO2 = 1.0 + 0.534e-6 * (375.0 - 450.0)
_MAPPING = np.array(
    [
        [12100.8e-7, 1729.5e-9, 319.1e-7, -1847.8e-11],
        [30496.5e-7, 234.4e-8, -103.5e-6, -185.6e-10],
        [6877.7e-5, 197.2e-7, -345.8e-5, 106.0e-9],
    ]
)
"""Coefficients of FCULa: of 1, the temperature [deg C], the cosine of the latitude, the height [m]."""

_KELVIN = 273.15
_LOVE, _SHIDA = (0.6078, -0.0006), (0.0847, 0.0002)
"""Numbers of degree 2, and how they change with the latitude."""


def vapour_pressure(pressure: np.ndarray, temperature: np.ndarray, humidity: np.ndarray) -> np.ndarray:
    """Return the pressure (n,) of water vapour [Pa] in air at a relative humidity [1] (Giacomo 1982)."""
    exponent = 1.2378847e-5 * temperature**2 - 1.9121316e-2 * temperature + 33.93711047
    saturated = np.exp(exponent - 6.3431645e3 / temperature)
    enhancement = 1.00062 + 3.14e-8 * pressure + 5.6e-7 * (temperature - _KELVIN) ** 2
    return np.asarray(humidity * enhancement * saturated)


def zenith_delay(
    pressure: np.ndarray, vapour: np.ndarray, wavelength: np.ndarray, latitude: np.ndarray, height: np.ndarray
) -> np.ndarray:
    """Return the troposphere's delay (n,) to the zenith [m], of light of a wavelength [m].

    pressure, vapour: of the air and of water in it [Pa]; latitude [rad], height [m]: of the station
    """
    square = (1e-6 / wavelength) ** 2
    dry = 19990.975 * (238.0185 + square) / (238.0185 - square) ** 2
    dry = 1e-2 * _CO2 * (dry + 579.55174 * (57.362 + square) / (57.362 - square) ** 2)
    wet = 0.003101 * (295.235 + square * (3 * 2.6422 + square * (-5 * 0.032380 + square * 7 * 0.004028)))
    gravity = 1.0 - 0.00266 * np.cos(2.0 * latitude) - 0.00000028 * height
    hydrostatic = 0.002416579 * dry * pressure
    return np.asarray(1e-2 * (hydrostatic + 1e-4 * (5.316 * wet - 3.759 * dry) * vapour) / gravity)


def mapped(
    elevation: np.ndarray, temperature: np.ndarray, latitude: np.ndarray, height: np.ndarray
) -> np.ndarray:
    """Return by how much (n,) a delay at an elevation [rad] is larger than to the zenith; temperature [K]."""
    terms = np.stack([np.ones_like(height), temperature - _KELVIN, np.cos(latitude), height])
    a1, a2, a3 = _MAPPING @ terms
    sine = np.sin(elevation)
    return np.asarray((1.0 + a1 / (1.0 + a2 / (1.0 + a3))) / (sine + a1 / (sine + a2 / (sine + a3))))


def bent(positions: np.ndarray, stations: np.ndarray) -> np.ndarray:
    """Return the delay (n,) [m] of light between positions and stations (n, 3) [m] by the Earth's mass."""
    far, near = np.linalg.norm(positions, axis=-1), np.linalg.norm(stations, axis=-1)
    between = np.linalg.norm(positions - stations, axis=-1)
    ratio = (far + near + between) / (far + near - between)
    return np.asarray(2.0 * EARTH_GM / SPEED_OF_LIGHT**2 * np.log(ratio))


def tide(position: np.ndarray, body: np.ndarray, gm: float) -> np.ndarray:
    """Return how far (n, 3) [m] the tide of a body moves stations at positions (n, 3) in ITRF [m].

    body: (n, 3) in ITRF [m]; gm: of the body [m3/s2]
    """
    up = position / np.linalg.norm(position, axis=-1, keepdims=True)
    distance = np.linalg.norm(body, axis=-1, keepdims=True)
    towards = body / distance
    cosine = np.sum(up * towards, axis=-1, keepdims=True)
    by_latitude = 0.5 * (3.0 * up[:, 2:] ** 2 - 1.0)
    love, shida = (first + second * by_latitude for first, second in (_LOVE, _SHIDA))
    upwards = love * 0.5 * (3.0 * cosine**2 - 1.0) * up
    aside = 3.0 * shida * cosine * (towards - cosine * up)
    return np.asarray(gm / EARTH_GM * WGS84_A**4 / distance**3 * (upwards + aside))
