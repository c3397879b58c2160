"""Arcs of several callers in the same blocks, so that objects with a few arcs each leave no lanes empty.

Each caller runs in a thread of its own, one at a time. One that asks for arcs waits until all others have
requested theirs or ended; then all arcs of a kind are propagated together, on a grid of epochs that is the
same whatever is propagated with them, so no caller's arcs depend on the others.
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from threading import Condition
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from opml.dynamics import ensemble
from opml.dynamics.ensemble import Arcs, Departures
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import Integrator

STEP = 300.0
"""Between the epochs of the grid, which are its multiples [s].

Arcs whose epochs are farther apart have a grid of more, `pace` of them, from where they begin.
"""

LONGEST_PACE = 6  # so that an hour has few grids

MOST = 1024
"""Arcs of one call where no single caller asks for more: a hundred callers' would take a gigabyte."""

Outcome = TypeVar("Outcome")

_Kind = tuple[int, Integrator, bool, int, int]


@dataclass(frozen=True)
class _Request:
    """Arcs that a caller waits for: arguments as those of `ensemble.propagate`, epochs by their multiple."""

    model: ForceModel
    epochs: np.ndarray
    departures: Departures
    integrator: Integrator
    threads: int
    arcs: Future[Arcs] = field(default_factory=Future)

    @property
    def pace(self) -> int:
        """Length in units of STEP of which all spaces between epochs are multiples."""
        return math.gcd(LONGEST_PACE, int(np.gcd.reduce(np.diff(self.epochs))))

    @property
    def kind(self) -> _Kind:
        """Common properties of arcs that are propagated together: model, integrator, direction and grid."""
        phase = int(self.epochs[0]) % self.pace
        forward = bool(self.epochs[0] <= self.epochs[-1])
        return id(self.model), self.integrator, forward, self.pace, phase

    @property
    def longest(self) -> int:
        """Length of the longest arc."""
        ends = (self.epochs[np.asarray(at)] for at in (self.departures.first, self.departures.last))
        return int(np.abs(np.subtract(*ends)).max())


class SharedBlocks:
    """Callers whose arcs share blocks."""

    def __init__(self) -> None:
        self._turn = Condition()
        self._under_way = 0
        self._waiting: list[_Request] = []

    def run(self, callers: Sequence[Callable[[], Outcome]]) -> list[Outcome]:
        """Return what callers return, in their order; raise what the first of them raises."""
        if not callers:
            return []
        self._under_way = len(callers)
        with ThreadPoolExecutor(len(callers)) as threads:
            outcomes = [threads.submit(self._run, caller) for caller in callers]
        return [outcome.result() for outcome in outcomes]

    def propagate(
        self,
        model: ForceModel,
        epochs: ArrayLike,
        departures: Departures,
        *,
        integrator: Integrator,
        threads: int = 1,
        progress: Callable[[float], None] | None = None,
    ) -> Arcs:
        """Propagate arcs as `ensemble.propagate`; those on the grid, during `run`, with other callers'."""
        epochs = np.asarray(epochs, float)
        multiples = np.round(epochs / STEP)
        stand_still = np.array_equal(departures.first, departures.last)
        if not self._under_way or stand_still or not np.array_equal(STEP * multiples, epochs):
            return ensemble.propagate(
                model, epochs, departures, integrator=integrator, threads=threads, progress=progress
            )
        request = _Request(model, multiples.astype(np.int64), departures, integrator, threads)
        self._waiting.append(request)
        self._propagate_when_all_wait()
        self._turn.wait_for(request.arcs.done)
        return request.arcs.result()

    def _run(self, caller: Callable[[], Outcome]) -> Outcome:
        """Run a caller while all others wait, and let these go on when it has ended."""
        with self._turn:
            try:
                return caller()
            finally:
                self._under_way -= 1
                self._propagate_when_all_wait()

    def _propagate_when_all_wait(self) -> None:
        """Propagate arcs of one kind, when there is no caller that does not wait for its own.

        It is the kind of the shortest arcs, so that the long ephemerides wait until all fits have ended: then
        more go together.
        """
        if not self._waiting or len(self._waiting) < self._under_way:
            return
        kind = min(self._waiting, key=lambda request: request.longest).kind
        same_kind = [request for request in self._waiting if request.kind == kind]
        arcs = np.cumsum([len(request.departures) for request in same_kind])
        _propagate(same_kind[: max(1, int(np.searchsorted(arcs, MOST, side="right")))])
        self._waiting = [request for request in self._waiting if not request.arcs.done()]
        self._turn.notify_all()


def _propagate(requests: Sequence[_Request]) -> None:
    """Propagate the arcs of requests of one kind, and hand them out."""
    try:
        arcs = _propagated(requests)
    except Exception as reason:
        for request in requests:
            request.arcs.set_exception(reason)
        return
    begin = 0
    for request in requests:
        count = len(request.departures)
        request.arcs.set_result(_own(arcs, begin, request))
        begin += count


def _propagated(requests: Sequence[_Request]) -> Arcs:
    first = requests[0]
    grid = _grid(requests)
    places = [np.abs(request.epochs - grid[0]) // first.pace for request in requests]
    departures = [request.departures for request in requests]
    outlooks = [request.departures.outlooks(first.model, STEP * request.epochs) for request in requests]
    together = Departures(
        np.concatenate([np.asarray(each.states) for each in departures]),
        first=np.concatenate([at[each.first] for at, each in zip(places, departures, strict=True)]),
        last=np.concatenate([at[each.last] for at, each in zip(places, departures, strict=True)]),
        ballistic=np.concatenate([np.asarray(each.ballistic) for each in departures]),
        reflection=np.concatenate([np.asarray(each.reflection) for each in departures]),
        outlook=np.concatenate(outlooks),
    )
    threads = max(request.threads for request in requests)
    return ensemble.propagate(
        first.model, STEP * grid, together, integrator=first.integrator, threads=threads
    )


def _grid(requests: Sequence[_Request]) -> np.ndarray:
    """Return the multiples from the first epoch of any request to the last, in their direction."""
    ends = np.array([[request.epochs[0], request.epochs[-1]] for request in requests])
    if requests[0].epochs[0] <= requests[0].epochs[-1]:
        return np.arange(ends[:, 0].min(), ends[:, 1].max() + 1, requests[0].pace)
    return np.arange(ends[:, 0].max(), ends[:, 1].min() - 1, -requests[0].pace)


def _own(arcs: Arcs, begin: int, request: _Request) -> Arcs:
    """Return a request's own arcs, from the one at `begin` on, at the request's own epochs."""
    first, last = (np.asarray(ends) for ends in (request.departures.first, request.departures.last))
    # Arcs were propagated at all epochs of the grid; a request has its own, counted from its start.
    count = last - first
    start = np.concatenate([[0], np.cumsum(count)])
    arc = np.repeat(np.arange(len(first)), count)
    epoch = first[arc] + np.arange(start[-1]) - start[arc] + 1
    passed = np.abs(request.epochs[epoch] - request.epochs[first[arc]]) // request.pace
    status = arcs.status[begin : begin + len(first)]
    return Arcs(arcs.states[arcs.start[begin + arc] + passed - 1], start, status)
