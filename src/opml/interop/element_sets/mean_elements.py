"""Mean elements propagated by SGP4, from TLEs or OMMs in KVN, JSON, XML or CSV, and RSOs from them.

    opml rso iss.tle --name mine --epoch 2016-09-28T12:09:45 \\
        --area-to-mass 0.05 --cd 2.2 --cr 1.25 >> config/rsos.tsv

adds an RSO to the sheet. Source: CCSDS 502.0-B-2, section 4 (OMM).
"""

import logging
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import cast

import numpy as np
from sgp4.api import SGP4_ERRORS, Satrec, SatrecArray

from opml.base import epochs
from opml.base.constants import DAY, EARTH_GM
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import formats
from opml.interop.element_sets import omm, tle
from opml.interop.element_sets.element_set import ElementSet, each, elements_epoch, seconds_since
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.interop.orbit_arcs import contents
from opml.orbits import sheets
from opml.orbits.elements import coe_from_cartesian, mean_from_true_anomaly

WARN_DAYS = 7.0
"""Days from the elements' epoch beyond which SGP4 propagates them with a warning.

A satellite departs from the orbit of its TLE by 1 to 3 km per day (documentation of the package sgp4), in a
week by more than the median error of the paper case's predictions, 5 km.
"""

MOST_DAYS = 30.0
"""Days from the elements' epoch beyond which they are refused: drag has moved a low orbit too far by then."""

Piece = omm.Record | Sequence[tle.Line]
"""The notation of a set: of an OMM, or lines of a TLE."""

_log = logging.getLogger(__name__)


def read(path: FilePath) -> Satrec:
    """Read the mean elements of a file: a TLE (with or without a name), or an OMM.

    Raises InputError, naming file and line or key, for a malformed file and one with several sets.
    """
    sets = read_sets(path)
    if len(sets) != 1:
        raise InputError(f"{path}: expected the mean elements of one RSO, got {len(sets)} sets")
    return sets[0].satellite


def read_sets(path: FilePath, damaged: list[InputError] | None = None) -> list[ElementSet]:
    """Read all sets of a file, plain or gzipped, in its order: TLEs, or OMMs in KVN, XML, JSON or CSV.

    damaged: takes the errors of the sets that are left out; None: the first error is raised

    Raises InputError, naming file and line, for a file that cannot be read as a whole or has no set.
    """
    sets, errors = _parsed(str(path), contents(path))
    if errors and damaged is None:
        raise errors[0]
    if damaged is not None:
        damaged.extend(errors)
    if not sets and not damaged:
        raise InputError(f"{path}: expected {formats.ELEMENTS}, got none")
    return [*sets]


@lru_cache(maxsize=4)
def _parsed(path: str, content: bytes) -> tuple[list[ElementSet], list[InputError]]:
    """Return the sets of a file and the errors of those that are damaged; a morning asks for them twice."""
    errors: list[InputError] = []
    placed = enumerate(pieces(path, content))
    return [*each(placed, lambda piece: element_set(path, *piece), errors)], errors


def pieces(path: FilePath, content: bytes) -> Iterator[Piece]:
    """Return the parts of a file, one for each set. Raises InputError for a broken notation, and another."""
    return cast("Iterator[Piece]", formats.read(path, content, formats.ELEMENTS))


def element_set(path: FilePath, place: int, piece: Piece) -> ElementSet:
    """Return the set of a piece. Raises InputError, naming the line, for a damaged one."""
    if isinstance(piece, omm.Record):
        return replace(omm.element_set(path, piece), place=place)
    return replace(tle.element_set(path, piece), place=place)


def state(satellite: Satrec, *, epoch: str) -> np.ndarray:
    """Return the osculating GCRF state (6,) [m, m/s] at a UTC text, by SGP4.

    Raises InputError where SGP4 fails (decayed, elements out of range).
    """
    [found] = states(satellite, epoch=epoch, t=np.zeros(1))
    if np.isnan(found).any():
        raise InputError(f"mean elements: expected an orbit at {epoch}, got {SGP4_ERRORS[satellite.error]}")
    return np.asarray(found)


def states(satellite: Satrec, *, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return osculating GCRF states (n, 6) [m, m/s] by SGP4, NaN where it fails (decayed)."""
    days = satellite.jdsatepochF + (t - seconds_since(epoch, [satellite])[0]) / DAY
    errors, *vectors = satellite.sgp4_array(np.full(len(t), satellite.jdsatepoch), days)
    of_date = np.where(errors[:, None] == 0, 1e3 * np.concatenate(vectors, axis=1), np.nan)
    turned = np.einsum("nij,nkj->nki", teme_to_gcrf(epoch, t), of_date.reshape(-1, 2, 3))
    return np.asarray(turned.reshape(-1, 6))


def states_in_teme(satellites: Sequence[Satrec], *, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return what SGP4 makes of sets with one epoch (k, n, 6) in TEME [m, m/s], NaN where it fails.

    t: (n,) times of all [s since the UTC text `epoch`]
    """
    first = satellites[0]
    days = first.jdsatepochF + (t - seconds_since(epoch, [first])[0]) / DAY
    errors, *vectors = SatrecArray([*satellites]).sgp4(np.full(len(t), first.jdsatepoch), days)
    return np.where(errors[..., None] == 0, 1e3 * np.concatenate(vectors, axis=-1), np.nan)


def check_age(satellite: Satrec, epoch: str) -> None:
    """Raise InputError, or warn, where the UTC text `epoch` is too far from that of the mean elements."""
    start = elements_epoch(satellite)
    days = abs(epochs.seconds_between(start, epoch)) / DAY
    if days > MOST_DAYS:
        raise InputError(
            f"mean elements: expected an epoch at most {MOST_DAYS:g} days from theirs, {start}, "
            f"got {epoch}, {days:.1f} days away"
        )
    if days > WARN_DAYS:
        _log.warning(
            "mean elements: SGP4 carries them %.1f days, from their epoch %s to %s; "
            "it errs by kilometres per day",
            days,
            start,
            epoch,
        )


def line_of_sheet(path: FilePath, *, name: str, epoch: str, area_to_mass: float, cd: float, cr: float) -> str:
    """Return the line of the sheet of RSOs for a file of mean elements, in the sheet's units.

    name: in the sheet; epoch: UTC text, at which osculating elements are by SGP4; area_to_mass: [m2/kg]

    B* is not used: it is fitted together with SGP4's own atmosphere. Raises InputError as `read` and
    `check_age` do, where SGP4 fails, and for a name or a body that the sheet would refuse.
    """
    sheets.check_body(name, {"area_to_mass_m2pkg": area_to_mass, "cd": cd, "cr": cr})
    satellite = read(path)
    check_age(satellite, epoch)
    a, e, *angles, nu = coe_from_cartesian(state(satellite, epoch=epoch), EARTH_GM).tolist()
    degrees = map(math.degrees, (*angles, float(mean_from_true_anomaly(nu, e))))
    return "\t".join([name, *map(repr, (a / 1e3, e, *degrees, float(area_to_mass), float(cd), float(cr)))])
