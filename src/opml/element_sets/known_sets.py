"""The public sets of one object, and when each was known."""

from collections.abc import Sequence
from functools import partial
from itertools import groupby

import numpy as np

from opml.base import epochs
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.element_sets import catalogue as catalogues
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import (
    ElementSet,
    each,
    numbered,
    of_files,
    seconds_since,
)
from opml.interop.object_ids import ObjectId

_TOLD = 10  # objects in an error


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
    damaged: list[InputError] = []
    read = of_files(catalogues.find_files(paths), partial(mean_elements.read_sets, damaged=damaged))
    sets = [*each(read, numbered, damaged)]
    if damaged and not sets:
        raise damaged[0]
    sets.sort(key=lambda one: (one.number, one.satellite.jdsatepoch + one.satellite.jdsatepochF, one.created))
    return {number: [*group] for number, group in groupby(sets, key=lambda one: one.number)}


def identity(one: ElementSet) -> ObjectId:
    """Return the object of a set; a name that is missing is its number."""
    return ObjectId.of(one.name or str(one.number), one.designator, str(one.number))


def since(
    epoch: str, history: Sequence[ElementSet], *, latency: float = catalogues.LATENCY, until: float = np.inf
) -> list[KnownSet]:
    """Return the sets of one object, by epoch, with their times since UTC text [s]; one of each epoch.

    latency: days from epoch to publication of sets that do not say when they were made
    until: those that were known later do not count [s]
    """
    t = seconds_since(epoch, [one.satellite for one in history])
    made = [
        epochs.seconds_between(epoch, one.created) if one.created else own + DAY * latency
        for one, own in zip(history, t, strict=True)
    ]
    known = {
        own: KnownSet(own, at, one.satellite)
        for own, at, one in zip(t, made, history, strict=True)
        if at <= until
    }
    return list(known.values())
