"""The grid of a tabulated thermosphere in local time, latitude and altitude; times are the environment's.

Between the nodes the logarithm of the density is cubic in space and linear in time. Altitudes are evenly
spaced in the square root of their height above 100 km, as the density falls off more slowly higher up.
"""

import math

LOCAL_TIMES = tuple(math.radians(15.0 * hour) for hour in range(24))
"""Mean local solar times [rad], 0 at midnight."""

LATITUDES = tuple(math.radians(10.0 * step) for step in range(-9, 10))
"""Geodetic latitudes [rad], from pole to pole."""

BASE, FIRST_ROOT, ROOT_STEP = 100.0, 3.0, 1.5
"""Altitudes are BASE + root^2 [km], with roots from FIRST_ROOT on in steps."""

ALTITUDES = tuple(1e3 * (BASE + (FIRST_ROOT + ROOT_STEP * k) ** 2) for k in range(24))
"""Geodetic altitudes [m]."""

DENSITIES = tuple(f"at_{altitude / 1e3:.0f}_km" for altitude in ALTITUDES)
"""Columns of the table `thermosphere`, one for each altitude."""
