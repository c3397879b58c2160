"""A set of mean elements for SGP4, from whatever format, and the reading of one set after the other."""

import copyreg
import logging
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any, TypeVar

import erfa
import numpy as np
from sgp4.api import SGP4_ERRORS, WGS72, Satrec

from opml.base import epochs
from opml.base.constants import DAY, EARTH_GM, WGS84_A
from opml.base.errors import InputError, OtherContentError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.interop.orbit_arcs import line_error

DEEP_SPACE = 2.0 * math.pi / 225.0  # mean motion [rad/min] below which SGP4 adds Sun and Moon
LOW = 600e3
"""Height below which drag outweighs what else changes the size of an orbit: B* below 0 is thrust [m]."""

PER_DAY = 1440.0 / (2.0 * math.pi)  # revolutions per day of a radian per minute

_SGP4_ZERO = datetime(1949, 12, 31)
_SGP4_ZERO_JULIAN = 2433281.5
_LEAPS = 2441317.5  # Julian date from which UTC has leap seconds, 1972-01-01; its seconds were longer before

_FASTEST = 18.0  # revolutions per day that no satellite makes: at the Earth's surface there were 17
_ROUNDING = 1e-9  # [deg]
_MINUTE = 60.0
_MINUTES_A_DAY = 1440.0
_EARTH_RADIUS = 6378.135e3  # WGS 72, the unit of SGP4's lengths [m]

_ANY = "2000-01-01T12:00:00"
_BAD_FILES = 4  # no more than one in so many files is skipped

_log = logging.getLogger(__name__)

_Piece = TypeVar("_Piece")


@dataclass(frozen=True)
class ElementSet:
    """A set of mean elements.

    path, line: where it is, a TLE by its line 1
    name, designator: of the object, as the file has them; '' where it has none
    """

    path: FilePath
    line: int
    number: int  # catalogue number, 0 where the file has none
    created: str  # UTC text, '' where unknown
    satellite: Satrec  # the elements, initialised; sgp4's own number is 0 beyond those of TLEs
    name: str = ""
    designator: str = ""
    place: int = 0  # number of sets before it in the file, damaged ones among them


def satellite(epoch: str, elements: Sequence[float]) -> Satrec:
    """Return the satellite of mean elements that SGP4 propagates.

    elements: mean motion [rad/min], eccentricity, inclination, right ascension of the node, argument of
        perigee, mean anomaly [rad], B*
    """
    days = (datetime.fromisoformat(epoch) - _SGP4_ZERO) / timedelta(days=1)
    return _initialised(days, elements)


def semi_major_axis(motion: np.ndarray) -> np.ndarray:
    """Return semi-major axes [m] of mean motions [rad/min]."""
    return np.asarray(np.cbrt(EARTH_GM / (np.asarray(motion) / _MINUTE) ** 2))


def mean_height(motion: np.ndarray) -> np.ndarray:
    """Return mean heights above the equatorial radius [m] of mean motions [rad/min]."""
    return semi_major_axis(motion) - WGS84_A


def changed(satellite: Satrec, motion: float, bstar: float) -> Satrec:
    """Return a set with another mean motion [rad/min] and B*."""
    _, (days, (_, *shape, _)) = _reduced(satellite)
    return _initialised(days, [motion, *shape, bstar])


def _days(satellite: Satrec) -> float:
    """Return the epoch of a set from SGP4's zero on [d]."""
    return float(satellite.jdsatepoch - _SGP4_ZERO_JULIAN + satellite.jdsatepochF)


def perturbed(satellite: Satrec, changes: Sequence[float] | np.ndarray) -> Satrec:
    """Return a set with other elements.

    changes: (6,) of the mean motion [rad/min], e cos w, e sin w, inclination, right ascension of the node and
        argument of latitude [rad]
    """
    motion, along, up, tilt, node, latitude = changes
    along += satellite.ecco * math.cos(satellite.argpo)
    up += satellite.ecco * math.sin(satellite.argpo)
    perigee = math.atan2(up, along)
    elements = [
        satellite.no_kozai + motion,
        math.hypot(along, up),
        satellite.inclo + tilt,
        satellite.nodeo + node,
        perigee,
        satellite.argpo + satellite.mo + latitude - perigee,
    ]
    return _initialised(_days(satellite), [*elements, satellite.bstar])


def decay(satellite: Satrec) -> float:
    """Return by how much the mean semi-major axis of a set sinks about its epoch by SGP4 [m/d]."""
    radius = [_mean_radius(satellite, minutes) for minutes in (-0.5 * _MINUTES_A_DAY, 0.5 * _MINUTES_A_DAY)]
    return radius[0] - radius[1]


def _mean_radius(satellite: Satrec, minutes: float) -> float:
    error, _, _ = satellite.sgp4_tsince(minutes)
    return float("nan") if error else float(satellite.am) * _EARTH_RADIUS


def propagate(satellite: Satrec, minutes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions [km] and velocities [km/s] (n, 3) in TEME after times (n,) [min], else NaN."""
    whole = np.full(len(minutes), satellite.jdsatepoch)
    errors, positions, velocities = satellite.sgp4_array(
        whole, satellite.jdsatepochF + minutes / _MINUTES_A_DAY
    )
    positions[errors != 0] = np.nan
    return positions, velocities


def perturb_drag(satellite: Satrec, part: float) -> Satrec:
    """Return a set with its B* larger by a part of it."""
    return changed(satellite, satellite.no_kozai, (1.0 + part) * satellite.bstar)


def _initialised(days: float, elements: Sequence[float]) -> Satrec:
    """Return the satellite of mean elements as in `satellite`; days: from SGP4's zero to their epoch."""
    motion, eccentricity, inclination, node, perigee, anomaly, bstar = elements
    satellite = Satrec()
    derivatives = 0.0, 0.0  # of the mean motion, which SGP4 does not use
    number = 0  # on which no orbit depends
    satellite.sgp4init(
        WGS72,
        "i",  # as TLEs are propagated
        number,
        days,
        bstar,
        *derivatives,
        eccentricity,
        perigee,
        inclination,
        anomaly,
        motion,
        node,
    )
    return satellite


def _reduced(satellite: Satrec) -> tuple[Any, ...]:
    """Return what makes the orbit of a set again, for copies and pickles, which sgp4 has not."""
    angles = satellite.inclo, satellite.nodeo, satellite.argpo, satellite.mo
    return _initialised, (_days(satellite), [satellite.no_kozai, satellite.ecco, *angles, satellite.bstar])


copyreg.pickle(Satrec, _reduced)


def elements_epoch(satellite: Satrec) -> str:
    """Return the epoch of mean elements as UTC text, to the microsecond."""
    return ccsds.utc_texts(_ANY, seconds_since(_ANY, [satellite]))[0]


def seconds_since(epoch: str, satellites: Sequence[Satrec]) -> np.ndarray:
    """Return the epochs (n,) of mean elements [s since the UTC text `epoch`], rounded to the microsecond."""
    midnights = np.array([satellite.jdsatepoch for satellite in satellites])
    fractions = np.array([satellite.jdsatepochF for satellite in satellites])
    is_early = midnights < _LEAPS
    with epochs.strict_erfa():
        day, fraction = erfa.utctai(midnights, np.where(is_early, fractions, 0.0))
    clocks = np.where(is_early, 0.0, fractions) * DAY  # on days of 86 401 s, too
    first, first_fraction = epochs.tai(epoch, 0.0)
    return np.asarray(np.round((day - first) * DAY + (fraction - first_fraction) * DAY + clocks, 6))


def each(
    pieces: Iterable[_Piece], parse: Callable[[_Piece], ElementSet], damaged: list[InputError] | None
) -> Iterator[ElementSet]:
    """Yield the sets of the pieces of a file.

    parse: raises InputError for a damaged piece
    damaged: takes the errors of the sets that are left out; None: the first error is raised
    """
    for piece in pieces:
        try:
            yield parse(piece)
        except InputError as error:
            if damaged is None:
                raise
            damaged.append(error)


def of_files(paths: Sequence[FilePath], read: Callable[[FilePath], Iterable[_Piece]]) -> list[_Piece]:
    """Return the content of all files; files that cannot be read are skipped, counted and named in the log.

    Lists of objects, and what else belongs beside sets, are passed over. Raises the InputError of the first
    of the others where they are more than one in _BAD_FILES, and where there is nothing else.
    """
    bad: list[InputError] = []
    beside: list[InputError] = []
    sets: list[_Piece] = []
    for path in paths:
        try:
            sets += read(path)
        except OtherContentError as error:
            beside.append(error)
        except InputError as error:
            bad.append(error)
    if _BAD_FILES * len(bad) > len(paths) or len(beside) == len(paths) > 0:
        first = (bad or beside)[0]
        limit = f"expected at most one in {_BAD_FILES} files to be unreadable"
        raise InputError(f"{first}; {limit}, got {len(bad)} of {len(paths)}") if bad[1:] else first
    for reason in beside:
        _log.warning("passed over: %s", reason)
    for reason in bad:
        _log.warning("skipped, a file of %d in %d: %s", len(bad), len(paths), reason)
    return sets


def numbered(one: ElementSet) -> ElementSet:
    """Return the set. Raises InputError where it does not name its object."""
    if one.number == 0:
        raise line_error(one.path, one.line, "a catalogue number above 0", "none")
    return one


def check_orbit(path: FilePath, line: int, satellite: Satrec) -> None:
    """Raise InputError, naming the line, for elements of no orbit, or that SGP4 cannot propagate."""
    motion, eccentricity = satellite.no_kozai * PER_DAY, satellite.ecco
    inclination = math.degrees(satellite.inclo)
    angles = map(math.degrees, (satellite.nodeo, satellite.argpo, satellite.mo))
    if not 0.0 < motion < _FASTEST:
        expected = f"a mean motion above 0 and below {_FASTEST:g} revolutions per day"
        raise line_error(path, line, expected, f"{motion:.8g}")
    if not 0.0 <= eccentricity < 1.0:
        raise line_error(path, line, "an eccentricity from 0 to below 1", f"{eccentricity:.7g}")
    if not 0.0 <= inclination <= 180.0 + _ROUNDING:
        raise line_error(path, line, "an inclination from 0 to 180 deg", f"{inclination:.7g}")
    for angle in angles:
        if not abs(angle) <= 360.0 + _ROUNDING:
            raise line_error(path, line, "angles of at most 360 deg", f"{angle:.7g}")
    if satellite.error:
        raise line_error(path, line, "elements that SGP4 can propagate", SGP4_ERRORS[satellite.error])
