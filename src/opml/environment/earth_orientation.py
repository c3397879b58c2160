"""Table of the Earth's orientation: celestial intermediate pole and origin, rotation angle, polar motion.

IAU 2006/2000A precession-nutation with the IERS's observed corrections (IERS Conventions 2010, chapter 5).
The sub-daily tidal and libration terms of its chapters 5 and 8 are not modelled (4e-9 rad on the paper's
days, 3 cm at an ISS).
"""

import hashlib
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path

import astropy_iers_data
import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, EARTH_RATE
from opml.base.errors import InputError
from opml.base.files import data_folder, read_text

_ABOUT = 4.0  # days beyond the ends of a run that its table may need
_ARCSECOND = np.pi / 648000.0
_TURN = 2.0 * np.pi

# Columns of finals2000A: the final value (Bulletin B), then the rapid or predicted one (Bulletin A).
_VALUES = {
    "x_pole": (slice(134, 144), slice(18, 27)),  # arcseconds
    "y_pole": (slice(144, 154), slice(37, 46)),  # arcseconds
    "ut1_utc": (slice(154, 165), slice(58, 68)),  # seconds
    "dx": (slice(165, 175), slice(97, 106)),  # milliarcseconds
    "dy": (slice(175, 185), slice(116, 125)),  # milliarcseconds
}


def tabulate(epoch: str, t: np.ndarray, *, bulletin: str | Path | None = None) -> pd.DataFrame:
    """Return the table `earth_orientation`.

    bulletin: path of a finals2000A file; None: `newest_bulletin`

    Columns: t [s]; x_cip, y_cip (CIP in GCRF, with the observed dX, dY), s_cio, x_pole, y_pole [rad];
    era_offset [rad]: the Earth rotation angle, unwrapped, minus EARTH_RATE * t.
    Raises InputError for dates outside the bulletin's.
    """
    t = np.asarray(t, dtype=float)
    tai, tt = epochs.tai(epoch, t), epochs.tt(epoch, t)
    ut1_tai, x_pole, y_pole, dx, dy = _interpolate(bulletin or newest_bulletin(), tai)

    x_cip, y_cip, _ = erfa.xys06a(*tt)
    x_cip, y_cip = x_cip + dx, y_cip + dy
    era = erfa.era00(tai[0], tai[1] + ut1_tai / DAY)
    return pd.DataFrame(
        {
            "t": t,
            "x_cip": x_cip,
            "y_cip": y_cip,
            "s_cio": erfa.s06(*tt, x_cip, y_cip),
            "x_pole": x_pole,
            "y_pole": y_pole,
            "era_offset": np.unwrap(np.mod(era - EARTH_RATE * t, _TURN)),
        }
    )


def bulletin_digest(epoch: str, duration_days: float, *, bulletin: str | Path | None = None) -> str:
    """Return the SHA-256 of the daily values that the table of a run is made from.

    epoch, duration_days: of the run, UTC text and days
    bulletin: as in `tabulate`

    Values that were predicted change with a later bulletin, those of days that are over hardly.
    """
    days, values = _bulletin(bulletin or newest_bulletin())
    whole, part = epochs.tai(epoch, np.array([0.0, DAY * duration_days]))
    begin, end = (whole - epochs.MJD_ZERO) + part
    used = (days > begin - _ABOUT) & (days < end + _ABOUT)
    return hashlib.sha256(np.ascontiguousarray(values[used]).tobytes()).hexdigest()


def fetched_bulletin() -> Path:
    """Return where `opml fetch` leaves the bulletin."""
    return data_folder() / "downloads" / "finals2000A.all"


@cache
def newest_bulletin() -> Path:
    """Return the bulletin that reaches later: the fetched one, or that of the package astropy_iers_data."""
    packaged, fetched = Path(astropy_iers_data.IERS_A_FILE), fetched_bulletin()
    return max([packaged, *([fetched] if fetched.exists() else [])], key=_last_day)


def _last_day(path: Path) -> str:
    return path.read_text(encoding="ascii", errors="replace").rstrip("\n").rpartition("\n")[2][7:15]


def metadata() -> dict[str, str]:
    """Return the sources of the figures, for the table's file metadata."""
    packaged = f"astropy-iers-data {version('astropy-iers-data')}"
    is_fetched = newest_bulletin() == fetched_bulletin()
    return {
        "bulletin": f"IERS finals2000A, {'fetched' if is_fetched else packaged}",
        "precession_nutation": "IAU 2006/2000A",
    }


def read_finals2000a(path: str | Path) -> pd.DataFrame:
    """Read the daily values of an IERS finals2000A file, for the days that have all of them.

    Columns: mjd (UTC midnights), x_pole, y_pole, dx, dy [rad], ut1_utc [s]; from Bulletin B, where it has the
    day, else A. Raises InputError where the file cannot be read or a figure is malformed.
    """
    return daily_values(path, read_text(path, "an IERS finals2000A file", encoding="ascii").splitlines())


def daily_values(path: str | Path, lines: Sequence[str]) -> pd.DataFrame:
    """Return the daily values of the lines of a finals2000A file as `read_finals2000a`."""
    rows = []
    for number, line in enumerate(lines, start=1):
        texts = [line[final].strip() or line[rapid].strip() for final, rapid in _VALUES.values()]
        if not all(texts):
            continue
        try:
            rows.append([float(line[7:15]), *map(float, texts)])
        except ValueError as reason:
            raise InputError(f"{path}: line {number}: expected figures, got {reason}") from None
    if not rows:
        raise InputError(f"{path}: expected daily rows in the columns of finals2000A, got none")

    bulletin = pd.DataFrame(rows, columns=["mjd", *_VALUES])
    bulletin[["x_pole", "y_pole"]] *= _ARCSECOND
    bulletin[["dx", "dy"]] *= 1e-3 * _ARCSECOND
    return bulletin


@cache
def _bulletin(path: str | Path) -> tuple[np.ndarray, np.ndarray]:
    """Return TAI modified Julian dates (m,) of the days, and their ut1_tai, x_pole, y_pole, dx, dy (m, 5)."""
    daily = read_finals2000a(path)
    tai_day, tai_fraction = erfa.utctai(epochs.MJD_ZERO, daily["mjd"].to_numpy())
    tai_mjd = (tai_day - epochs.MJD_ZERO) + tai_fraction
    # UT1 - TAI runs smoothly through leap seconds; UT1 - UTC would jump.
    ut1_tai = daily["ut1_utc"] - np.round((tai_mjd - daily["mjd"]) * DAY, 6)
    return tai_mjd, np.column_stack([ut1_tai, daily[["x_pole", "y_pole", "dx", "dy"]]])


def _interpolate(path: str | Path, tai: epochs.JulianDate) -> np.ndarray:
    days, values = _bulletin(path)
    mjd = (tai[0] - epochs.MJD_ZERO) + tai[1]
    start = np.searchsorted(days, mjd, side="right") - 2
    if np.any(start < 0) or np.any(start + 3 >= len(days)):
        raise InputError(
            f"{Path(path).name}: epoch: expected dates from "
            f"{epochs.calendar(days[1])} to {epochs.calendar(days[-2])}, "
            f"got {epochs.calendar(mjd.min())} to {epochs.calendar(mjd.max())}"
        )
    window = start[:, None] + np.arange(4)
    return np.asarray(np.einsum("qk,qkc->cq", lagrange_weights(days[window], mjd), values[window]))


def lagrange_weights(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the weights (q, k) of Lagrange's polynomial through `nodes` (q, k) at `x` (q,)."""
    weights = np.ones_like(nodes)
    for k in range(nodes.shape[1]):
        for other in range(nodes.shape[1]):
            if other != k:
                weights[:, k] *= (x - nodes[:, other]) / (nodes[:, k] - nodes[:, other])
    return weights
