"""Histories of element sets that tests make: objects that sink as their drag has it, a set a day."""

from functools import partial
from pathlib import Path

import numpy as np

from opml.element_sets.inside import inside_forces, inside_now
from opml.interop.element_sets import tle
from opml.interop.element_sets.element_set import mean_height, satellite

FIRST = "2025-11-20T02:00:00"
"""Epoch of the first set of each history."""

_MOTIONS = (15.50, 15.30, 15.05, 14.75)  # revolutions a day: 390 to 640 km
_NOISE = 3e-6  # of the mean longitude [rad], some 20 m


def height_of(number: int) -> float:
    """Return the mean height of an object at first [m]."""
    motion = 2.0 * np.pi / 1440.0 * _MOTIONS[number % len(_MOTIONS)]
    return float(mean_height(np.array([motion]))[0])


def sets_of(number: int, days: int, *, seed: int = 7, densities: np.ndarray | None = None) -> list[str]:
    """Return lines of TLEs of one object, a set a day; its drag varies, its sets err.

    densities: relative ones of the days; the drag follows them, and a set has that of the three days before.
    None: a set has the drag of its own day, which is drawn
    """
    rng = np.random.default_rng([seed, number])
    motion = 2.0 * np.pi / 1440.0 * (_MOTIONS[number % len(_MOTIONS)] + 0.02 * rng.random())
    inclination, node, perigee, anomaly = rng.uniform([0.9, 0.0, 0.0, 0.0], [1.7, 6.2, 6.2, 6.2])
    lines: list[str] = []
    for day in range(days):
        drag = published = 1e-4 * (1.0 + 0.3 * np.sin(0.4 * day + number) + 0.1 * rng.standard_normal())
        if densities is not None:
            drag, published = 1e-4 * densities[day], 1e-4 * densities[max(day - 3, 0) : day or 1].mean()
        epoch = str(np.datetime64(FIRST) + np.timedelta64(day, "D"))
        noisy = (anomaly + _NOISE * rng.standard_normal()) % (2.0 * np.pi)
        made = satellite(epoch, [motion, 1e-3, inclination, node, perigee, noisy, published])
        lines += tle.lines(made, number)
        # A day on, without the noise; SGP4 keeps Brouwer's mean motion, a set has Kozai's.
        made = satellite(epoch, [motion, 1e-3, inclination, node, perigee, anomaly, drag])
        made.sgp4_tsince(0.0)
        kozai = motion / made.nm
        made.sgp4_tsince(1440.0)
        motion = made.nm * kozai
        node, perigee, anomaly = (angle % (2.0 * np.pi) for angle in (made.Om, made.om, made.mm))
    return lines


def write(path: Path, numbers: range, days: int, *, seed: int = 7) -> None:
    """Write the histories of objects as a file of TLEs."""
    lines = [line for number in numbers for line in sets_of(number, days, seed=seed)]
    path.write_text("\n".join(lines) + "\n")


def seek_coarsely(put=setattr) -> None:
    """Have orbits inside sets sought under a field of degree 8, by four sets before: SGP4 made these."""
    put(inside_forces, "read", partial(inside_forces.read, degree=8))
    put(inside_now, "MOST", 4)
