"""Tools that fly in turns, so that a slow spell of the machine meets all alike."""

from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np

from benchmarks import measure
from benchmarks.case import Arcs
from benchmarks.peers import PEERS
from benchmarks.worker import Absent, Timed, Worker

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Flight:
    """Arcs that a tool flies at one of its settings."""

    worker: Worker
    arcs: Arcs
    setting: str

    def fly(self) -> Timed:
        """Return the timed states (n, 6) at the ends of the arcs. Raises Absent with what went wrong."""
        return self.worker.call("fly", self.arcs, self.setting)


@dataclass
class Flown:
    """What the rounds of a flight gave: the states (n, 6) at the ends of its arcs, and its times."""

    states: np.ndarray = field(default_factory=lambda: np.empty((0, 6)))
    cpu: list[float] = field(default_factory=list)  # ms per arc-day, a round each
    wall: list[float] = field(default_factory=list)


@contextmanager
def started(orekit_data: Path | None) -> Iterator[tuple[dict[str, Worker], dict[str, str]]]:
    """Yield the peers' workers by name, and why others did not start; all end with the context."""
    workers, absent = {}, {}
    for name in PEERS:
        try:
            workers[name] = _start(name, orekit_data)
        except Absent as reason:
            absent[name] = str(reason)
    try:
        yield workers, absent
    finally:
        for worker in workers.values():
            worker.close()


def _start(name, orekit_data):
    if name != "orekit":
        return Worker(name)
    if orekit_data is None:
        raise Absent("needs a folder of Orekit's data: make bench OREKIT_DATA=<folder>")
    return Worker(name, orekit_data)


def fly(
    flights: Mapping[Key, Flight], *, rounds: int, progress: Callable[[str], None], longest: float = np.inf
) -> dict[Key, Flown]:
    """Fly all flights once in every round, but a flight that took longer than `longest` [s] only once."""
    flown = {key: Flown() for key in flights}
    again = dict(flights)
    for number in range(rounds):
        progress(f"round {number + 1} of {rounds}")
        for key, flight in list(again.items()):
            timed, arc_days = flight.fly(), flight.arcs.arc_days
            flown[key].states = timed.result
            flown[key].cpu.append(measure.per_arc_day(timed.cpu, arc_days))
            flown[key].wall.append(measure.per_arc_day(timed.wall, arc_days))
            if timed.cpu > longest:
                del again[key]
    return flown
