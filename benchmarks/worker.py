"""A peer in a process of its own, on one core, so that no tool's threads or settings touch another's."""

import multiprocessing
import os
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from benchmarks import peers

_ONE_THREAD = dict.fromkeys(
    ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS", "NUMBA_NUM_THREADS"],
    "1",
)


class Absent(Exception):
    """Why a peer does not take part."""


@dataclass(frozen=True)
class Timed:
    """What a call returned, and its time on the clock and on the processor [s]."""

    result: Any
    wall: float
    cpu: float


class Worker:
    """Calls a peer's methods in its own process. Raises Absent where the peer cannot be made.

    location: where the peer's class stands
    """

    def __init__(self, location: str, *arguments: Any):
        os.environ.update(_ONE_THREAD)  # read by the libraries of the new process
        context = multiprocessing.get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=_serve, args=(other, location, arguments), daemon=True)
        self.process.start()
        other.close()
        self.about = self._answer()

    def call(self, method: str, *arguments: Any) -> Timed:
        """Call a method of the peer and time it. Raises Absent with what went wrong there."""
        self.connection.send((method, arguments))
        return self._answer()

    def close(self) -> None:
        """End the process, if it has not ended by itself."""
        with suppress(OSError):
            self.connection.send(None)
        self.process.join()

    def _answer(self):
        try:
            answer = self.connection.recv()
        except EOFError:
            raise Absent(f"its process ended with status {self.process.exitcode}") from None
        if isinstance(answer, Absent):
            self.process.join()
            raise answer
        return answer


def _serve(connection, location, arguments):
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    try:
        peer = peers.load(location)(*arguments)
        connection.send(peers.about(peer))
        while (request := connection.recv()) is not None:
            method, values = request
            wall, cpu = time.perf_counter(), time.process_time()
            result = getattr(peer, method)(*values)
            timed = Timed(result, time.perf_counter() - wall, time.process_time() - cpu)
            connection.send(timed)
    except Exception as reason:
        connection.send(Absent(" ".join(f"{type(reason).__name__}: {reason}".split())))
