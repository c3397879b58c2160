"""Progress of a command: in place on a terminal, a line each in a log."""

import shutil
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

Progress = Callable[[str], None]  # takes a line for each stage

Item = TypeVar("Item")

_CLEAR = "\r\033[K"
_PREFIX = "opml: "
_MINUTES = 100.0  # from which on minutes are shown [s]


@contextmanager
def on_stderr() -> Iterator[Progress]:
    """Yield a function that prints lines on stderr; on a terminal each replaces the one before."""
    begin = clear()

    def write(line: str) -> None:
        text = f"{_PREFIX}{line}"
        in_place = f"{begin}{text[: shutil.get_terminal_size().columns - 1]}"
        print(in_place if begin else text, end="" if begin else "\n", file=sys.stderr, flush=True)

    try:
        yield write
    finally:
        print(begin, end="", file=sys.stderr, flush=True)


def counted(number: int, noun: str) -> str:
    """Return how many there are, as 1 object, 2 objects."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def clear() -> str:
    """Return the end of a line that is printed away from a terminal, '' where stderr is one."""
    return _CLEAR if sys.stderr.isatty() else ""


def with_time_left(
    items: Sequence[Item], name: str, progress: Progress, *, clock: Callable[[], float] = time.monotonic
) -> Iterator[Item]:
    """Yield items; tell before each its number and, but for the first, the time that is left."""
    begin = clock()
    for number, item in enumerate(items):
        left = f", {remaining(clock() - begin, number / len(items))}" if number else ""
        progress(f"{name} {number + 1} of {len(items)}{left}")
        yield item


def remaining(passed: float, share: float) -> str:
    """Return the time that is left in words; passed: so far [s], share: of the work that is done."""
    left = passed * (1.0 - share) / share
    return f"{left:.0f} s left" if left < _MINUTES else f"{left / 60.0:.0f} min left"
