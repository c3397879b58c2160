"""Histories of mean elements: all sets of objects from files, and the states that SGP4 has for each.

history = histories.read(["before_2024.tle.gz", "since.csv"], epoch="2024-01-01T00:00:00")
goce = histories.of_object(history.sets, 34602)
states = histories.states_of(goce.iloc[-1], epoch="2024-01-01T00:00:00", t=np.array([7200.0]))
"""

import logging
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds
from opml.interop.element_sets import element_set, mean_elements
from opml.interop.element_sets.element_set import ElementSet, each, numbered, seconds_since
from opml.interop.object_ids import ObjectId
from opml.tables import ELEMENTS, SCHEMAS

_TLE_DAY = 1e8  # parts of a day that the epoch of a TLE resolves; an OMM's epoch has two digits more
_SAME = 1e-12  # relative difference of elements that two notations of the same number may have

_MOST_LOGGED = 10
_MOST_DAMAGED = 0.05  # of all sets
_ZERO = 2433281.5  # some Julian date at midnight
_MINUTE = 60.0

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class History:
    """Sets of mean elements of one object or several."""

    sets: pd.DataFrame  # table `element_sets`, by object and epoch
    doubles: int  # number of sets that were there already
    superseded: int  # number of sets in whose place others of the same epoch came
    out_of_order: int  # number of sets that came after a later one of their object
    damaged: Sequence[InputError]  # errors of the sets that are left out
    objects: Mapping[int, ObjectId]  # what the newest set of each catalogue number shows about its object


def read(paths: Iterable[FilePath], *, epoch: str, leave_out_damaged: bool = False) -> History:
    """Read the history in files, each of TLEs (with or without names) or OMMs in KVN, XML, JSON or CSV.

    paths: plain or gzipped, of any formats; of sets made at the same time the one that is read later counts
    leave_out_damaged: however many damaged sets there are; otherwise one in twenty at most

    Damaged sets are left out, counted and logged.

    Of several sets of an object with the same epoch, the one with the latest date of creation counts, without
    such dates the last one. Counts of all that is not in the table are logged. Raises InputError, naming file
    and line, for the first of too many damaged sets, and for a file that cannot be read as a whole.
    """
    damaged: list[InputError] = []
    sets = element_set.of_files([*paths], partial(mean_elements.read_sets, damaged=damaged))
    found = list(each(sets, numbered, damaged))
    if not leave_out_damaged and len(damaged) > _MOST_DAMAGED * (len(found) + len(damaged)):
        raise damaged[0]
    issues = _by_epoch(found)
    kept = [_distinct(sets) for sets in issues.values()]
    history = History(
        sets=_table([sets[-1] for sets in kept], epoch),
        doubles=len(found) - sum(map(len, kept)),
        superseded=sum(map(len, kept)) - len(kept),
        out_of_order=_out_of_order(found),
        damaged=damaged,
        objects={
            one.number: ObjectId.of(one.name or str(one.number), one.designator, str(one.number))
            for one in (sets[-1] for sets in kept)
        },
    )
    _log_counts(history)
    return history


def of_object(sets: pd.DataFrame, number: int | None = None) -> pd.DataFrame:
    """Return the sets of one object of a table `element_sets`.

    number: its catalogue number; None: there is only one object

    Raises InputError, naming the objects that there are, where there are no such sets.
    """
    numbers = sets["number"].unique()
    known = ", ".join(map(str, numbers[:_MOST_LOGGED])) + (", ..." if len(numbers) > _MOST_LOGGED else "")
    if number is None and len(numbers) > 1:
        raise InputError(f"element sets: expected a number that names the object, got objects {known}")
    chosen = sets if number is None else sets[sets["number"] == number].reset_index(drop=True)
    if chosen.empty:
        expected = "a set" if number is None else f"object {number}"
        raise InputError(f"element sets: expected {expected}, got {known or 'none'}")
    return chosen


def states_of(row: pd.Series, *, epoch: str, t: np.ndarray) -> np.ndarray:
    """Return GCRF states (n, 6) [m, m/s] by SGP4 from a set at times (n,) [s], NaN where it fails.

    row, epoch: as in `satellite`
    """
    return mean_elements.states(satellite(row, epoch=epoch), epoch=epoch, t=t)


def satellite(row: Mapping[Any, Any] | pd.Series, *, epoch: str) -> Satrec:
    """Return the satellite of a row of a table `element_sets` that SGP4 propagates."""
    (time,) = ccsds.utc_texts(epoch, np.array([row["t"]]))
    motion, *others = [float(row[name]) for name in ELEMENTS]
    return element_set.satellite(time, [_MINUTE * motion, *others])


def _by_epoch(sets: Iterable[ElementSet]) -> dict[tuple[int, int], list[ElementSet]]:
    """Return the sets of each object and epoch in the order of their creation, unknown dates first."""
    issues = defaultdict(list)
    for one in sets:
        made = one.satellite
        parts = round((made.jdsatepoch - _ZERO) * _TLE_DAY + made.jdsatepochF * _TLE_DAY)
        issues[one.number, parts].append(one)
    return {key: sorted(issues[key], key=lambda issue: issue.created) for key in sorted(issues)}


def _distinct(issues: Sequence[ElementSet]) -> list[ElementSet]:
    """Return the sets of one epoch without those that repeat the one before them."""
    distinct: list[ElementSet] = []
    for issue in issues:
        if not distinct or not _same(distinct[-1], issue):
            distinct.append(issue)
        elif not distinct[-1].created:
            distinct[-1] = issue  # which may say when it was made
    return distinct


def _same(one: ElementSet, other: ElementSet) -> bool:
    pairs = zip(_elements(one), _elements(other), strict=True)
    return all(math.isclose(a, b, rel_tol=_SAME, abs_tol=_SAME * _SAME) for a, b in pairs)


def _elements(one: ElementSet) -> tuple[float, ...]:
    made = one.satellite
    return (made.no_kozai / _MINUTE, made.ecco, made.inclo, made.nodeo, made.argpo, made.mo, made.bstar)


def _out_of_order(sets: Iterable[ElementSet]) -> int:
    latest: dict[int, tuple[float, float]] = {}
    count = 0
    for one in sets:
        time = one.satellite.jdsatepoch, one.satellite.jdsatepochF
        count += time < latest.get(one.number, time)
        latest[one.number] = max(time, latest.get(one.number, time))
    return count


def _table(sets: Sequence[ElementSet], epoch: str) -> pd.DataFrame:
    elements = np.array([_elements(one) for one in sets]).reshape(-1, len(ELEMENTS))
    created = [epochs.seconds_between(epoch, one.created) if one.created else np.nan for one in sets]
    columns = {
        "number": np.array([one.number for one in sets], dtype=np.int64),
        "t": seconds_since(epoch, [one.satellite for one in sets]),
        **dict(zip(ELEMENTS, elements.T, strict=True)),
        "is_deep": np.array([one.satellite.method == "d" for one in sets], dtype=bool),
        "t_created": np.array(created, dtype=float),
        "file": [Path(one.path).name for one in sets],
        "line": np.array([one.line for one in sets], dtype=np.int64),
    }
    return pd.DataFrame(columns)[SCHEMAS["element_sets"].names]


def _log_counts(history: History) -> None:
    sets = history.sets
    _log.info("sets of mean elements: %d, of objects: %d", len(sets), sets["number"].nunique())
    if deep := int(sets["is_deep"].sum()):
        _log.info("sets with a period of 225 minutes or more: %d", deep)
    if history.out_of_order:
        _log.info("sets that came after a later one: %d", history.out_of_order)
    if history.doubles:
        _log.warning("sets left out that were there already: %d", history.doubles)
    if history.superseded:
        _log.warning("sets left out for later ones of the same epoch: %d", history.superseded)
    if history.damaged:
        _log.warning("damaged sets left out: %d", len(history.damaged))
    for error in history.damaged[:_MOST_LOGGED]:
        _log.warning("%s", error)
