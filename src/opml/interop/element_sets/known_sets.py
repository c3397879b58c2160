"""The sets of objects in files and folders, and when each was known."""

import logging
from collections.abc import Iterable, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import ElementSet, each, numbered, of_files, seconds_since
from opml.interop.object_ids import ObjectId

LATENCY = 0.25  # days from the epoch of a set to its publication, where the set does not say when it was made

SUFFIXES = (".tle", ".txt", ".3le", ".json", ".csv", ".xml", ".kvn", ".omm")
"""Endings of the files of a folder that are read, `.gz` after them or not."""

_TOLD = 10  # objects in an error
_DAMAGED = 20  # a file is refused where more than one set of so many cannot be read

_log = logging.getLogger(__name__)


def find_files(paths: Iterable[FilePath]) -> list[Path]:
    """Return the files of paths, those of a folder by their names.

    Raises InputError for a path that is missing, and a folder without element sets.
    """
    return [file for path in paths for file in _files_of(Path(path))]


def _files_of(path: Path) -> list[Path]:
    if not path.exists():
        raise InputError(f"{path}: no such file")
    if not path.is_dir():
        return [path]
    files = sorted(
        file for file in path.rglob("*") if file.name.lower().removesuffix(".gz").endswith(SUFFIXES)
    )
    if not files:
        raise InputError(f"{path}: expected files of element sets ({', '.join(SUFFIXES)}), got none")
    return files


def readable(path: FilePath, leave_out_damaged: bool = False) -> list[ElementSet]:
    """Return the sets of a file that name their object; the others are counted in the log.

    leave_out_damaged: however many damaged sets there are; otherwise one in twenty at most

    Raises InputError for the first of too many damaged sets, and for a file without any that is whole.
    """
    damaged: list[InputError] = []
    sets = [*each(mean_elements.read_sets(path, damaged), numbered, damaged)]
    too_many = not sets if leave_out_damaged else _DAMAGED * len(damaged) > len(sets) + len(damaged)
    if damaged and too_many:
        raise damaged[0]
    if damaged:
        _log.warning("%s: damaged sets left out: %d, the first: %s", path, len(damaged), damaged[0])
    if supplemental := sum(one.satellite.classification == "C" for one in sets):
        warning = "%s: sets of operators' ephemerides: %d: burns to come are in them, errors are of others"
        _log.warning(warning, path, supplemental)
    return sets


def of_object(paths: Sequence[FilePath], wanted: str | None) -> list[ElementSet]:
    """Return the sets of one object in the order of their epochs.

    paths: files and folders; wanted: name, designator or number; None: they have one object alone

    Raises InputError for unreadable files, and without one object of that name.
    """
    histories = by_object(paths)
    newest = {number: sets[-1] for number, sets in histories.items()}
    named = [number for number, one in newest.items() if wanted is None or identity(one).is_called(wanted)]
    if len(named) != 1:
        there = ", ".join(f"{number} {one.name}".strip() for number, one in sorted(newest.items())[:_TOLD])
        more = ", ..." if len(newest) > _TOLD else ""
        expected = "--object for one of several objects" if wanted is None else f"one object {wanted}"
        raise InputError(f"{paths[0]}: expected {expected}, got {there or 'no set'}{more}")
    return histories[named[0]]


def by_object(paths: Sequence[FilePath]) -> dict[int, list[ElementSet]]:
    """Return the sets of files and folders by the number of the object, in the order of their epochs.

    Raises InputError for unreadable files.
    """
    sets = of_files(find_files(paths), partial(readable, leave_out_damaged=True))
    sets.sort(key=lambda one: (one.number, one.satellite.jdsatepoch + one.satellite.jdsatepochF, one.created))
    return {number: [*group] for number, group in groupby(sets, key=lambda one: one.number)}


def identity(one: ElementSet) -> ObjectId:
    """Return the object of a set; a name that is missing is its number."""
    return ObjectId.of(one.name or str(one.number), one.designator, str(one.number))


def since(
    epoch: str, history: Sequence[ElementSet], *, latency: float = LATENCY, until: float = np.inf
) -> list[KnownSet]:
    """Return the sets of one object, by epoch, with their times since UTC text [s]; one of each epoch.

    latency: days from epoch to publication of sets that do not say when they were made
    until: those that were known later do not count [s]
    """
    t = seconds_since(epoch, [one.satellite for one in history])
    published = [
        epochs.seconds_between(epoch, one.created) if one.created else own + DAY * latency
        for one, own in zip(history, t, strict=True)
    ]
    known = {
        own: KnownSet(own, at, one.satellite)
        for own, at, one in zip(t, published, history, strict=True)
        if at <= until
    }
    return list(known.values())
