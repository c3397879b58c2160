"""A sheet of random RSOs: ``opml sheet --count 12 --seed 7``."""

import numpy as np

from opml.base.constants import WGS84_A
from opml.base.errors import InputError
from opml.base.seeds import derive
from opml.orbits.sheets import NAME, NAME_WANTED

_COLUMNS = (
    "name",
    "a_km",
    "e",
    "i_deg",
    "argp_deg",
    "raan_deg",
    "mean_anomaly_deg",
    "area_to_mass_m2pkg",
    "cd",
    "cr",
)
"""Columns of the sheet of RSOs."""

_ALTITUDES_KM = (350.0, 600.0)
_ECCENTRICITIES = (0.0002, 0.004)
_INCLINATIONS = (40.0, 100.0)
_AREA_TO_MASS = (0.003, 0.02)
_CD = (1.8, 2.8)
_CR = 1.2


def draw(name: str, seed: int) -> list[str]:
    """Return one line of the sheet: numbers uniform in their ranges, area to mass in its logarithm."""
    random = derive(seed, "drawn", name)
    numbers = {
        "a_km": WGS84_A / 1e3 + random.uniform(*_ALTITUDES_KM),
        "e": random.uniform(*_ECCENTRICITIES),
        "i_deg": random.uniform(*_INCLINATIONS),
        **{f"{angle}_deg": random.uniform(0.0, 360.0) for angle in ("argp", "raan", "mean_anomaly")},
        "area_to_mass_m2pkg": np.exp(random.uniform(*np.log(_AREA_TO_MASS))),
        "cd": random.uniform(*_CD),
        "cr": _CR,
    }
    return [name, *(f"{value:.6g}" for value in numbers.values())]


def sheet(prefix: str, count: int, seed: int) -> str:
    """Return a sheet of `count` RSOs, whose names are `prefix` and a number from 01 on.

    Raises InputError for no count, and for a prefix that no name has.
    """
    if count < 1:
        raise InputError(f"--count: expected a whole number from 1, got {count}")
    if not NAME.fullmatch(f"{prefix}{count:02d}"):
        raise InputError(f"--prefix: expected {NAME_WANTED}, got {prefix!r}")
    lines = [_COLUMNS, *(draw(f"{prefix}{number:02d}", seed) for number in range(1, count + 1))]
    return "".join("\t".join(line) + "\n" for line in lines)
