"""Tools that fly in turns, so that a slow spell of the machine meets all alike."""

from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from benchmarks import measure
from benchmarks.case import Arcs
from benchmarks.peers import FLYERS
from benchmarks.worker import Absent, Timed, Worker

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Propagation:
    """Arcs that a tool flies at one of its settings."""

    worker: Worker
    arcs: Arcs
    setting: str

    def fly(self) -> Timed:
        """Return the timed states (n, 6) at the ends of the arcs. Raises Absent with what went wrong."""
        return self.worker.call("fly", self.arcs, self.setting)


@dataclass(frozen=True)
class Flown:
    """What the rounds of a propagation gave: the states (n, 6) at the ends of its arcs, and its times."""

    states: np.ndarray
    cpu: list[float]  # ms per arc-day, a round each
    wall: list[float]


@contextmanager
def started(
    orekit_data: Path | None, peers: Mapping[str, str] = FLYERS
) -> Iterator[tuple[dict[str, Worker], dict[str, str]]]:
    """Yield the workers of peers by name, and why others did not start; all end with the context.

    peers: where the class of each stands, by its name
    """
    workers, absent = {}, {}
    for name, location in peers.items():
        try:
            workers[name] = _start(name, location, orekit_data)
        except Absent as reason:
            absent[name] = str(reason)
    try:
        yield workers, absent
    finally:
        for worker in workers.values():
            worker.close()


def _start(name, location, orekit_data):
    if name != "orekit":
        return Worker(location)
    if orekit_data is None:
        raise Absent("needs a folder of Orekit's data: make bench OREKIT_DATA=<folder>")
    return Worker(location, orekit_data)


def take(
    calls: Mapping[Key, Callable[[], Timed]],
    *,
    rounds: int,
    progress: Callable[[str], None],
    longest: float = np.inf,
) -> dict[Key, list[Timed]]:
    """Make all calls once in every round, but a call that took longer than `longest` [s] only once."""
    taken: dict[Key, list[Timed]] = {key: [] for key in calls}
    again = dict(calls)
    for number in range(rounds):
        progress(f"round {number + 1} of {rounds}")
        for key, call in list(again.items()):
            timed = call()
            taken[key].append(timed)
            if timed.cpu > longest:
                del again[key]
    return taken


def fly(
    propagations: Mapping[Key, Propagation],
    *,
    rounds: int,
    progress: Callable[[str], None],
    longest: float = np.inf,
) -> dict[Key, Flown]:
    """Make all propagations in turns, as `take`."""
    calls = {key: one.fly for key, one in propagations.items()}
    taken = take(calls, rounds=rounds, progress=progress, longest=longest)
    return {key: _flown(propagations[key].arcs.arc_days, times) for key, times in taken.items()}


def _flown(arc_days, times):
    return Flown(
        times[-1].result,
        cpu=[measure.per_arc_day(timed.cpu, arc_days) for timed in times],
        wall=[measure.per_arc_day(timed.wall, arc_days) for timed in times],
    )
