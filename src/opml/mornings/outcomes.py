"""Outcomes of objects on a day, in a file; pages are made of it without what mornings need to run."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np

from opml.base.constants import EARTH_GM, WGS84_A
from opml.base.files import FilePath, replacing, unpacked
from opml.orbits.elements import coe_from_cartesian

GOOD, UNPROVEN, WIDE, DO_NOT_USE = "good", "unproven", "wide", "do not use"  # verdicts
FAILED = "failed"  # the verdict where a morning could not be run

NOTHING: dict[str, Any] = {
    "model": None,
    "message": None,
    "newest_estimate": None,
    "age_hours": None,
    "burn": None,
    "height_km": None,
    "inclination_deg": None,
    "tracks": 0,
    "converged": 0,
    "late": 0,
    "expected": [],
    "scores": [],
    "past": {},
    "mornings": [],
    "beside_sgp4": [],
}
"""What is told of a morning that could not be run."""


def write(path: FilePath, outcomes: Any) -> None:
    """Write what became of objects as JSON, plain or for a name that ends in `.gz` compressed."""
    text = f"{json.dumps(outcomes, separators=(',', ':'), allow_nan=False)}\n".encode()
    with replacing(path) as temporary:
        temporary.write_bytes(gzip.compress(text, mtime=0) if Path(path).suffix == ".gz" else text)


def read(path: FilePath) -> list[dict[str, Any]]:
    """Return what became of objects."""
    return json.loads(unpacked(Path(path).read_bytes()))


def orbit(state: np.ndarray) -> dict[str, float]:
    """Return mean height above the equator [km] and inclination [deg] of a GCRF state (6,) [m, m/s]."""
    a, _, inclination, *_ = coe_from_cartesian(state, EARTH_GM).tolist()
    return {
        "height_km": round((a - WGS84_A) / 1e3, 1),
        "inclination_deg": round(float(np.degrees(inclination)), 2),
    }


def expected(days: np.ndarray, sigmas: np.ndarray) -> list[dict[str, float]]:
    """Return standard deviations (n, 3) in RSW [m] after whole days (n,)."""
    names = ("day", "radial_sigma_m", "along_track_sigma_m", "cross_track_sigma_m")
    rows = zip(days.astype(int).tolist(), *sigmas.T.tolist(), strict=True)
    return [dict(zip(names, (day, *map(rounded, row)), strict=True)) for day, *row in rows]


def rounded(length: float) -> float:
    """Return a length to a decimetre [m]."""
    return round(float(length), 1)
