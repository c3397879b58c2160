"""Constants: physical ones in SI units, each with its source, and the width of the kernels."""

import math

HOUR = 3600.0  # seconds in an hour
DAY = 24.0 * HOUR  # seconds in a day
JULIAN_YEAR = 365.25 * DAY  # seconds in a Julian year

GM = {
    "sun": 132712440041.279419e9,
    "moon": 4902.800118e9,
    "mercury": 22031.868551e9,
    "venus": 324858.592000e9,
    "mars": 42828.375816e9,
    "jupiter": 126712764.100000e9,
    "saturn": 37940584.841800e9,
    "uranus": 5794556.400000e9,
    "neptune": 6836527.100580e9,
    "pluto": 975.500000e9,
}
"""Gravitational parameters [m3/s2] of the Sun, the Moon and the planets, a planet together with its moons.

DE440: Park, Folkner, Williams & Boggs 2021, AJ 161:105 (and the comment area of the kernel itself).
"""

BODIES = tuple(GM)  # names of the third bodies, in the order of the tables' columns

EARTH_GM = 3.986004415e14
"""Earth's gravitational parameter [m3/s2] of EGM2008 and EIGEN-6S, for the elements of the sheet of RSOs."""

EARTH_ANGULAR_MOMENTUM = 9.8e8
"""The Earth's angular momentum per mass [m2/s] (IERS Conventions 2010, sec. 10.3)."""

WGS84_A = 6378137.0  # equatorial radius of the WGS84 ellipsoid [m] (NGA.STND.0036)
WGS84_F = 1.0 / 298.257223563  # flattening of the WGS84 ellipsoid (NGA.STND.0036)
SUN_RADIUS = 6.957e8  # nominal solar radius [m] (IAU 2015 Resolution B3)

SRP_PRESSURE = 4.56e-6
"""Solar radiation pressure on an absorbing surface at SRP_DISTANCE [N/m2] (the paper's 'SRP')."""

SRP_DISTANCE = 149_597_870.0e3  # distance from the Sun at which SRP_PRESSURE holds [m] (the paper's 'SRP')

EARTH_RATE = 2.0 * math.pi * 1.00273781191135448 / DAY
"""Rate of the Earth rotation angle [rad/s] (IERS Conventions 2010, eq. 5.15)."""

SPEED_OF_LIGHT = 299_792_458.0  # speed of light in vacuum [m/s] (SI)

LANES = 16
"""Arcs that a kernel propagates side by side, in the time of one.

Two AVX-512 registers of doubles: enough independent work to hide the latency of a fused multiply and add.
"""
