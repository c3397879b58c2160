"""Density from a table over time, local time, latitude and altitude, on `opml.base.thermosphere_grid`.

The logarithm is interpolated through four nodes in each direction of space, and linearly in time. Lanes are
looked up one after the other, as each is at another place.
"""

import math

from opml.base.thermosphere_grid import ALTITUDES, BASE, FIRST_ROOT, LATITUDES, LOCAL_TIMES, ROOT_STEP
from opml.dynamics.kernels.lanes import WIDTH, compiled, exp, load, select, store

_TURN = 2.0 * math.pi
_HOURS = len(LOCAL_TIMES)
_PARALLELS = len(LATITUDES)
_HEIGHTS = len(ALTITUDES)
_LOWEST, _HIGHEST = ALTITUDES[0], ALTITUDES[-1]
_SINE, _COSINE, _EAST_SINE, _EAST_COSINE, _HEIGHT, _LOGARITHM = range(6)
"""Rows of the scratch lanes; the last holds the logarithm of the density."""


@compiled
def density(altitude, sin_lat, cos_lat, sin_lon, cos_lon, table, node, part, clock, scratch):
    """Return the density [kg/m3]: that of the lowest altitude below the table, and 0 above the table.

    altitude: geodetic [m]
    table: logarithms (nodes, local times, latitudes, altitudes)
    node, part: the node before the time, and the part of a step since
    clock: UTC as a part of the day
    scratch: six rows of lanes
    """
    store(scratch, _SINE, sin_lat)
    store(scratch, _COSINE, cos_lat)
    store(scratch, _EAST_SINE, sin_lon)
    store(scratch, _EAST_COSINE, cos_lon)
    store(scratch, _HEIGHT, altitude)
    for lane in range(WIDTH):
        hour = math.atan2(scratch[_EAST_SINE, lane], scratch[_EAST_COSINE, lane]) / _TURN + clock
        parallel = 0.5 + math.atan2(scratch[_SINE, lane], scratch[_COSINE, lane]) / math.pi
        height = min(max(scratch[_HEIGHT, lane], _LOWEST), _HIGHEST)
        root = (math.sqrt(1e-3 * height - BASE) - FIRST_ROOT) / ROOT_STEP
        scratch[_LOGARITHM, lane] = _between(
            table, node, part, (hour - math.floor(hour)) * _HOURS, parallel * (_PARALLELS - 1), root
        )
    return select(altitude > _HIGHEST, 0.0, exp(load(scratch, _LOGARITHM)))


@compiled
def _between(table, node, part, hour, parallel, root):
    """Return the logarithm of the density at a place, in steps of the grid from its first node."""
    i = math.floor(hour)
    j = min(max(math.floor(parallel), 1), _PARALLELS - 3)
    k = min(max(math.floor(root), 1), _HEIGHTS - 3)
    hour_weights, parallel_weights = _weights(hour - i), _weights(parallel - j)
    root_weights = _weights(root - k)
    total = 0.0
    for p in range(4):
        meridian = (i + p - 1) % _HOURS
        for q in range(4):
            weight = hour_weights[p] * parallel_weights[q]
            for r in range(4):
                now = table[node, meridian, j + q - 1, k + r - 1]
                then = table[node + 1, meridian, j + q - 1, k + r - 1]
                total += weight * root_weights[r] * (now + part * (then - now))
    return total


@compiled
def _weights(u):
    """Return the weights of Lagrange's polynomial at u through nodes at -1, 0, 1 and 2."""
    a, b, c, d = u + 1.0, u, u - 1.0, u - 2.0
    return -b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0
