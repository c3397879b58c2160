"""Processes that share Orekit's long runs, each with a JVM of its own."""

import multiprocessing
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor

from validation.orekit import Data, Orekit, start

PROCESSES = 2

_orekit: list[Orekit] = []
"""This process's Orekit, once `_begin` has run."""


class Workers:
    """A pool of PROCESSES in which functions of an Orekit run; a context manager."""

    def __init__(self, data: Data, epoch: str, *, progress: Callable[[str], None]):
        # A JVM does not survive a fork.
        spawn = multiprocessing.get_context("spawn")
        self._pool = ProcessPoolExecutor(PROCESSES, spawn, initializer=_begin, initargs=(data, epoch))
        self._progress = progress

    def __enter__(self) -> "Workers":
        return self

    def __exit__(self, reason, *_):
        self._pool.shutdown(cancel_futures=reason is not None)

    def submit(self, label: str, function: Callable, *arguments) -> Future:
        """Run function(orekit, *arguments) in turn; `label` is told as it ends."""
        future = self._pool.submit(_call, function, arguments)
        future.add_done_callback(lambda done: self._tell(label, done))
        return future

    def _tell(self, label, done):
        if not done.cancelled():
            self._progress(f"{label}: {done.exception() or 'done'}")


def _begin(data, epoch):
    start(data)
    _orekit.append(Orekit(epoch))


def _call(function, arguments):
    return function(_orekit[0], *arguments)
