"""Two orbits compared: their difference in RSW, time by time, and the share inside the covariance.

    table = comparison.compare(known_orbits.read(["mine.oem"]), known_orbits.read(["truth.sp3"]))
    print(comparison.summary(table))

Orbits are those of `known_orbits`.
"""

import logging
from collections.abc import Mapping

import numpy as np
import pandas as pd
from scipy.stats import chi2

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.interop import ccsds
from opml.interop.ephemeris import EPOCH
from opml.interop.known_orbits import KnownOrbit, Sets
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import least_variances, mahalanobis

FLOWN_DAYS = 7.0  # time over which two orbits are compared that are both of mean elements [d]
LEVELS = (0.5, 0.9)  # shares that the ellipsoids of a covariance hold which a summary counts
_FLAT = 1e-12  # least variance of scaled axes that makes an ellipsoid, but for rounding
MOST_ROWS = 14  # largest number of rows of a summary
_SPACINGS = (0.1, 0.5, 1.0, 3.0, 6.0, 12.0, 24.0, 72.0, 240.0, 720.0, 2400.0)  # [h]

_STEP = 60.0  # between times of two orbits of mean elements [s]
_ALONE = 1.0  # time after the newest set of a truth from which it is told that there are no more [d]
_WHOLE = 10.0  # length from which on whole metres tell enough [m]

_log = logging.getLogger(__name__)


def compare(ours: KnownOrbit, other: KnownOrbit) -> pd.DataFrame:
    """Return the table `comparison`: ours less the other, at the times of the other's states.

    Where the other has mean elements, or ours knows nothing between its own states, the times are those of
    ours; where both have mean elements, every minute of a week from our newest set on.
    Along the track the distance is an arc, so that a satellite far ahead is not below. Objects that are known
    to be two are logged. Raises InputError where both know nothing of the same time.
    """
    if ours.identity.is_another(other.identity):
        _log.warning("compare: expected orbits of one object, got %s and %s", ours.identity, other.identity)
    t = _times(ours, other)
    mine, theirs = ours.at(t), other.at(t)
    both = np.isfinite(mine[:, :3]).all(axis=1) & np.isfinite(theirs[:, :3]).all(axis=1)
    theirs[:, 3:] = np.where(np.isfinite(theirs[:, 3:]), theirs[:, 3:], mine[:, 3:])
    both &= np.isfinite(theirs[:, 3:]).all(axis=1)
    if not both.any():
        spans = [(one.source, *ccsds.utc_texts(EPOCH, one.t[[0, -1]])) for one in (ours, other)]
        got = " and ".join("{} from {} to {}".format(*span) for span in spans)
        raise InputError(f"compare: expected two orbits of the same time, got {got}")
    t, mine, theirs = t[both], mine[both], theirs[both]
    if isinstance(other, Sets) and (alone := (t[-1] - other.t[-1]) / DAY) > _ALONE:
        ends = f"{other.source} ends on {ccsds.utc_texts(EPOCH, other.t[-1:])[0][:10]}"
        _log.warning("compare: %s: after it SGP4 propagates its newest set, up to %.1f d", ends, alone)
    difference = bent_rsw(mine[:, :3], theirs)
    covariances = ours.covariances(t)[:, :3, :3]
    known = np.isfinite(covariances).all(axis=(1, 2))
    share = np.full(len(t), np.nan)
    known[known] = least_variances(covariances[known]) > _FLAT
    share[known] = chi2.cdf(mahalanobis(difference[known], covariances[known]), 3)
    if flat := int(np.count_nonzero(np.isfinite(covariances).all(axis=(1, 2)) & ~known)):
        _log.warning("compare: covariances not positive definite, without an ellipsoid: %d", flat)
    sigma = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    return pd.DataFrame(
        {
            "utc": ccsds.utc_texts(EPOCH, t),
            "hours": (t - t[0]) / HOUR,
            **dict(zip(("r", "s", "w"), difference.T, strict=True)),
            "distance": np.linalg.norm(mine[:, :3] - theirs[:, :3], axis=1),
            **dict(zip(("sigma_r", "sigma_s", "sigma_w"), sigma.T, strict=True)),
            "ellipsoid": share,
        }
    )


def summary(table: pd.DataFrame) -> str:
    """Return root mean squares by time as aligned text, and how much lies inside the covariance."""
    columns = ["r", "s", "w", "distance", "sigma_r", "sigma_s", "sigma_w"]
    begins = _begins(table["hours"], table["hours"].iloc[-1])
    rows = np.sqrt((table[columns] ** 2).groupby(begins).mean())
    rows.insert(0, "times", table.groupby(begins).size())
    rows = rows.dropna(axis="columns", how="all").rename(columns={name: f"{name}_m" for name in columns})
    begin = f"root mean square differences from {table['utc'].iloc[0][:19]} UTC on"
    lines = [f"{begin}: radial (r), along the track (s), across it (w)", _aligned(rows)]
    inside = table["ellipsoid"].dropna()
    if len(inside):
        shares = ", ".join(
            f"the {100.0 * level:.0f} % ellipsoid contains {100.0 * np.mean(inside <= level):.0f} %"
            for level in LEVELS
        )
        lines.append(f"of {len(inside)} points {shares}")
    return "\n".join(lines)


def side_by_side(tables: Mapping[str, pd.DataFrame], other: str) -> str:
    """Return root mean square distances [m] of several orbits from another by time, as aligned text.

    tables: of `compare` by the orbit's name, with the same other orbit; times that all have count
    """
    distances = [one.set_index("utc")["distance"].rename(name) for name, one in tables.items()]
    rows = pd.concat(distances, axis="columns", join="inner")
    if rows.empty:
        raise InputError(f"compare: expected orbits of the same time, got none that {other} shares with all")
    hours = next(iter(tables.values())).set_index("utc")["hours"].loc[rows.index]
    begins = _begins(hours, hours.iloc[-1])
    shown = np.sqrt((rows**2).groupby(begins).mean())
    return f"root mean square distances [m] from {other}, from {rows.index[0][:19]} UTC on\n{_aligned(shown)}"


def _begins(hours: pd.Series, end: float) -> pd.Series:
    """Return the beginning [h] of the interval of each time, of MOST_ROWS intervals at most."""
    spacing = next((one for one in _SPACINGS if end < MOST_ROWS * one), _SPACINGS[-1])
    last = max(np.ceil(end / spacing) - 1.0, 0.0)
    return spacing * np.minimum(np.floor(hours / spacing), last)


def _aligned(rows: pd.DataFrame) -> str:
    def metres(length: float) -> str:
        return f"{length:.0f}" if length >= _WHOLE else f"{length:.2f}"

    rows.insert(0, "from_h", rows.index)
    formats = dict.fromkeys(rows.columns, metres) | {"from_h": "{:g}".format, "times": "{:.0f}".format}
    return rows.to_string(index=False, formatters=formats, na_rep="-")


def _times(ours: KnownOrbit, other: KnownOrbit) -> np.ndarray:
    if isinstance(ours, Sets) and isinstance(other, Sets):
        return np.arange(ours.t[-1], ours.t[-1] + DAY * FLOWN_DAYS, _STEP)
    if isinstance(other, Sets) or not np.isfinite(ours.at(other.t)).any():
        return ours.t
    return other.t
