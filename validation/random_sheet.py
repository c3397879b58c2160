"""A sheet of random RSOs, to measure how long many take.

python -m validation.random_sheet --count 12 --seed 7
"""

import argparse
import sys
from collections.abc import Sequence

import numpy as np

from opml.base.constants import WGS84_A
from opml.base.seeds import derive

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


def main(arguments: Sequence[str]) -> None:
    """Print a sheet, whose names are the prefix and a number from 01 on."""
    parser = argparse.ArgumentParser(description="Print a random sheet of RSOs.")
    parser.add_argument("--count", type=int, required=True, help="number of RSOs")
    parser.add_argument("--seed", type=int, required=True, help="seed of the draw")
    parser.add_argument("--prefix", default="sky", help="first part of each name (sky)")
    asked = parser.parse_args(arguments)
    names = [f"{asked.prefix}{number:02d}" for number in range(1, asked.count + 1)]
    for line in (_COLUMNS, *(draw(name, asked.seed) for name in names)):
        print("\t".join(line))


if __name__ == "__main__":
    main(sys.argv[1:])
