"""Manoeuvres: when they were and since when they are known, and tests of spans of time for them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np

from opml.base import epochs
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.yaml_files import read_yaml
from opml.tables import read_metadata

LISTED = "manoeuvre_timestamps"  # key of the times in a YAML file of manoeuvres


@dataclass(frozen=True)
class Manoeuvre:
    """A manoeuvre."""

    t: float  # when it was [s]
    known: float = -math.inf  # since when it is known [s]; one that somebody named always was
    restarts: bool = False  # whether the windows of fits restart after it, once it is known

    @property
    def counts_from(self) -> float:
        """Since when it counts [s]: it was, and is known."""
        return max(self.t, self.known)


def contain_any(
    begin: np.ndarray, end: np.ndarray, manoeuvres: Sequence[Manoeuvre], *, window: float = 0.0
) -> np.ndarray:
    """Return which spans (begin, end], (n,) [s], contain a manoeuvre that was known by their ends: (n,).

    window: of the fits that spans begin with [s], which have to be free of one, too, if they hold it
    """
    contain = np.zeros(len(end), dtype=bool)
    for one in manoeuvres:
        first = begin if one.restarts else begin - window
        contain |= (first < one.t) & (one.counts_from <= end)
    return contain


def when_burns_are_known(begin: np.ndarray, end: np.ndarray, manoeuvres: Sequence[Manoeuvre]) -> np.ndarray:
    """Return when a manoeuvre in each span (begin, end], (n,) [s], becomes known: (n,) [s].

    Infinite without one, and where fits had restarted after it by the end of the span.
    """
    since = np.full(len(end), np.inf)
    for one in manoeuvres:
        counts = one.counts_from
        hold = (begin < one.t) & (one.t <= end) & ((counts > end) | (not one.restarts))
        since[hold] = np.minimum(since[hold], counts)
    return since


def are_unaware(
    begin: np.ndarray, end: np.ndarray, manoeuvres: Sequence[Manoeuvre], *, window: float
) -> np.ndarray:
    """Return which predictions (begin, end], (n,) [s], go across a manoeuvre, or begin with a fit across it.

    manoeuvres: that are known now; of fits that were made since they are, none goes across
    window: of the fits [s]
    """
    unaware = np.zeros(len(end), bool)
    for one in manoeuvres:
        unaware |= (begin - window < one.t) & (one.t < end) & ((begin < one.t) | (begin < one.known))
    return unaware


def at_times(times: Sequence[str], *, epoch: str) -> list[Manoeuvre]:
    """Return manoeuvres at UTC texts, in order of time.

    epoch: UTC text that their times count from

    Raises InputError on a malformed text.
    """
    return [Manoeuvre(t) for t in sorted(epochs.seconds_between(epoch, time) for time in times)]


def facts(manoeuvres: Sequence[Manoeuvre]) -> dict[str, Any]:
    """Return manoeuvres as a table's metadata hold them."""
    return {"manoeuvres": [_fact(one) for one in manoeuvres]}


def _fact(one: Manoeuvre) -> dict[str, Any]:
    known = {"known": one.known} if math.isfinite(one.known) else {}
    return {"t": one.t} | known | ({"restarts": True} if one.restarts else {})


def read_manoeuvres(path: FilePath) -> list[Manoeuvre]:
    """Read the manoeuvres that a table's metadata hold. Raises as `read_metadata` does."""
    listed = read_metadata(path).get("manoeuvres", [])
    return [Manoeuvre(one["t"], one.get("known", -math.inf), one.get("restarts", False)) for one in listed]


def read_times(path: FilePath) -> list[str]:
    """Read the UTC texts in a YAML file of manoeuvres: a list of times, or one under `manoeuvre_timestamps`.

    Raises InputError for a file that is missing, no such list, or has an entry that is no time.
    """
    content = read_yaml(path)
    times = content.get(LISTED) if isinstance(content, dict) else content
    if not isinstance(times, list):
        raise InputError(f"{path}: expected a list of times, or one under {LISTED}, got neither")
    return [_utc_text(path, number, time) for number, time in enumerate(times, start=1)]


def _utc_text(path: FilePath, number: int, time: Any) -> str:
    """Return an entry of a list as UTC text; YAML reads times without quotes itself."""
    if isinstance(time, datetime):
        utc = time.astimezone(UTC) if time.tzinfo else time
        return utc.replace(tzinfo=None).isoformat()
    try:
        epochs.parse(time)
    except InputError:
        raise InputError(
            f"{path}: entry {number}: expected a time like 2016-09-28 12:09:45, got {time}"
        ) from None
    return str(time)
