"""Passes of a predicted object over a place, and how many seconds early or late they may be."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import erfa
import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import WGS84_A
from opml.base.errors import InputError
from opml.catalog.simulate.observing import horizon, observe
from opml.dynamics.frames import gcrf_to_itrf
from opml.environment import earth_orientation, nodes
from opml.interop import ccsds, known_orbits
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.orbits.rsw_covariance import half_width
from opml.tables import SCHEMAS, write_as

MASK = float(np.radians(5.0))  # elevation above which an object passes [rad]
LEVEL = 0.9  # share of passes that are no earlier or later than told
_SHOWN = 5  # passes of a text
_STEP = 20.0  # between looks [s]
_WGS84 = 1
_BOUNDS = ((-90.0, 90.0), (-180.0, 360.0), (-500.0, 10_000.0))


@dataclass(frozen=True)
class Place:
    """A place on WGS84 [rad, m], under the name that its user gave it."""

    name: str
    latitude: float
    longitude: float
    altitude: float


def place(text: str) -> Place:
    """Return a place of latitude, longitude [deg] and altitude [m], as 52.2,21.0,110.

    Raises InputError for another text.
    """
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    numbers += [0.0] * (len(numbers) == len(_BOUNDS) - 1)
    if len(numbers) != len(_BOUNDS) or not all(
        low <= number <= high for number, (low, high) in zip(numbers, _BOUNDS, strict=True)
    ):
        raise InputError(f"--station: expected latitude,longitude,altitude as 52.2,21.0,110, got {text}")
    latitude, longitude, altitude = numbers
    return Place(text, float(np.radians(latitude)), float(np.radians(longitude)), altitude)


def in_itrf(orbit: Ephemeris, date: str, t: np.ndarray) -> np.ndarray:
    """Return positions (n, 3) in ITRF [m] at times (n,) [s since the date of the orbit, UTC text]."""
    return np.asarray(np.einsum("nij,nj->ni", _turns(orbit, date, t), orbit.at(t)[:, :3]))


def mask(degrees: float) -> float:
    """Return the least elevation of passes [rad]. Raises InputError for one that no pass or all have."""
    if not 0.0 <= degrees < 90.0:
        raise InputError(f"--mask: expected 0 deg or more and less than 90, got {degrees:g}")
    return float(np.radians(degrees))


def _turns(orbit: Ephemeris, date: str, t: np.ndarray) -> np.ndarray:
    """Return the rotations (n, 3, 3) from GCRF to ITRF at times (n,) [s since the date]."""
    return gcrf_to_itrf(earth_orientation.tabulate(date, nodes(date, orbit.t[-1])), t)


def passes(orbit: Ephemeris, date: str, where: Place, mask: float = MASK) -> pd.DataFrame:
    """Return the table `passes` over a place above an elevation `mask` [rad].

    date: UTC text from which times of the orbit count, at which it begins

    A pass that is under way at the beginning or the end is left out.
    """
    t = np.arange(0.0, orbit.t[-1], _STEP)
    elevation = _seen(orbit, date, where, t)[:, 1]
    rows = []
    for first, last in _spans(elevation > mask):
        rise, fall = (_crossing(t, elevation, k, mask) for k in (first - 1, last - 1))
        fine = np.linspace(rise, fall, max(int(fall - rise), 2))
        top = fine[int(np.argmax(_seen(orbit, date, where, fine)[:, 1]))]
        moments = np.array([rise, top, fall])
        azimuth, heights = np.degrees(_seen(orbit, date, where, moments)[:, :2]).T
        (state,), (covariance,) = orbit.at(moments[1:2]), orbit.covariances_at(moments[1:2])
        sunlit, sun = _light(orbit, date, top, state[:3], where)
        late = half_width(LEVEL) * float(np.sqrt(covariance[1, 1]) / np.linalg.norm(state[3:]))
        times = ccsds.utc_texts(date, moments)
        rows.append((where.name, *times, *azimuth, float(heights[1]), late, sunlit, sun))
    return pd.DataFrame(rows, columns=SCHEMAS["passes"].names)


def joined(passes: Mapping[Place, pd.DataFrame]) -> pd.DataFrame:
    """Return the passes over several stations in the order of their rises."""
    return pd.concat(passes.values(), ignore_index=True).sort_values(["rise", "station"], ignore_index=True)


def write_beside(message: Path, places: Iterable[Place]) -> None:
    """Write the passes of an ephemeris message's object over places as `passes.csv` beside it."""
    [orbit] = known_orbits.segments(message, epoch=EPOCH)
    (date,) = ccsds.utc_texts(EPOCH, orbit.t[:1])
    over = {where: passes(orbit.shifted(-orbit.t[0]), date, where) for where in places}
    write_as(message.with_name("passes.csv"), joined(over), "passes", metadata={})


def text(passes: Mapping[Place, pd.DataFrame]) -> str:
    """Return the first passes as aligned text, or that there is none."""
    rows = joined(passes)
    shown = rows.head(_SHOWN).replace(dict.fromkeys(("rise", "highest", "set"), r"\..*$"), "", regex=True)
    aligned = shown.to_string(index=False, float_format="{:.1f}".format) if len(shown) else "none"
    return f"passes, {len(shown)} of {len(rows)}: UTC, angles [deg], early or late by [s]\n{aligned}"


def _seen(orbit: Ephemeris, date: str, where: Place, t: np.ndarray) -> np.ndarray:
    """Return azimuth, elevation [rad] and range [m] (n, 3) at times (n,) [s since the date]."""
    site = np.array(erfa.gd2gc(_WGS84, where.longitude, where.latitude, where.altitude))
    return observe(in_itrf(orbit, date, t), site, horizon(where.longitude, where.latitude))


def _light(orbit: Ephemeris, date: str, t: float, position: np.ndarray, where: Place) -> tuple[bool, float]:
    """Return whether the Sun shines on a position (3,) in GCRF [m], and its elevation over a place [deg].

    The Earth's shadow is a cylinder: the penumbra lasts seconds. Source: erfa.epv00.
    """
    with epochs.strict_erfa():
        heliocentric, _ = erfa.epv00(*epochs.tt(date, t))
    sun = -np.asarray(heliocentric["p"])
    sun /= np.linalg.norm(sun)
    ahead = float(position @ sun)
    is_sunlit = ahead > 0.0 or bool(np.linalg.norm(position - ahead * sun) > WGS84_A)
    (turn,) = _turns(orbit, date, np.array([t]))
    up = horizon(where.longitude, where.latitude)[2]
    return is_sunlit, float(np.degrees(np.arcsin(up @ turn @ sun)))


def _spans(is_up: np.ndarray) -> Iterator[tuple[int, int]]:
    """Yield first index and the one after the last of each run of truth that begins and ends within."""
    edges = np.flatnonzero(np.diff(is_up.astype(int))) + 1
    begins = edges[is_up[edges]]
    for begin in begins:
        if len(ends := edges[edges > begin]):
            yield int(begin), int(ends[0])


def _crossing(t: np.ndarray, elevation: np.ndarray, k: int, mask: float) -> float:
    """Return when the elevation crosses the mask between looks k and k + 1, on a straight line [s]."""
    share = (mask - elevation[k]) / (elevation[k + 1] - elevation[k])
    return float(t[k] + share * (t[k + 1] - t[k]))
