"""Refraction of raw measurements of radars and telescopes: air delays ranges and lifts elevations.

The air above a station is a standard one: pressure and temperature fall with its height as in ISO 2533, half
of the vapour that the air could hold is there. Weather changes delays and bending by some percent.

Source: Saastamoinen 1972 (delay to the zenith), mapped by `range_corrections.mapped`; Bennett 1982, Journal
of Navigation 35, 255-259 (refraction), by the refractivity of the air on the ground (Smith & Weintraub
1953 for radio).
"""

import numpy as np

from opml.catalog.fit.range_corrections import mapped, vapour_pressure

_HUMIDITY = 0.5
_BENNETT = 282.0e-6  # refractivity of the air that Bennett's formula is made for, 1010 hPa and 10 deg C


def standard(altitude: float) -> tuple[float, float, float]:
    """Return the pressure [Pa], temperature [K] and vapour pressure [Pa] of air at an altitude [m]."""
    pressure = 101325.0 * (1.0 - 2.25577e-5 * altitude) ** 5.25588
    temperature = 288.15 - 0.0065 * altitude
    vapour = vapour_pressure(np.array(pressure), np.array(temperature), np.array(_HUMIDITY))
    return pressure, temperature, float(vapour)


def zenith_delay(latitude: float, altitude: float) -> float:
    """Return the delay [m] of radio waves to the zenith at a latitude [rad] and altitude [m]."""
    pressure, temperature, vapour = standard(altitude)
    gravity = 1.0 - 0.00266 * np.cos(2.0 * latitude) - 0.00000028 * altitude
    dry, wet = 2.2768e-5 * pressure, 2.277e-5 * (1255.0 / temperature + 0.05) * vapour
    return float(dry / gravity + wet)


def delay(elevation: np.ndarray, latitude: float, altitude: float) -> np.ndarray:
    """Return by how much (n,) a range is too long [m], at elevations (n,) of the straight line [rad]."""
    (_, temperature, _), everywhere = standard(altitude), np.ones_like(elevation)
    times = mapped(elevation, temperature * everywhere, latitude * everywhere, altitude * everywhere)
    return zenith_delay(latitude, altitude) * times


def bending(elevation: np.ndarray, altitude: float, *, radio: bool) -> np.ndarray:
    """Return by how much (n,) measured elevations (n,) are too high [rad].

    radio: of radio waves, which water bends, too; else of light
    """
    (pressure, temperature, vapour), degrees = standard(altitude), np.degrees(elevation)
    refractivity = 77.6e-8 * pressure / temperature
    if radio:
        refractivity += 3.73e-3 * vapour / temperature**2
    else:
        refractivity *= 1.02
    shape = 1.0 / np.tan(np.radians(degrees + 7.31 / (degrees + 4.4)))
    return np.asarray(np.radians(shape / 60.0) * refractivity / _BENNETT)
