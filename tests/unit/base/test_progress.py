"""What a command tells while it runs, on a terminal and in a log."""

import io
from itertools import count

import pytest

from opml.base import progress


class Screen(io.StringIO):
    """A terminal."""

    def isatty(self):
        return True


def test_a_log_has_a_line_each(capsys):
    with progress.on_stderr() as tell:
        tell("weather")
        tell("fits")
    assert capsys.readouterr().err == "opml: weather\nopml: fits\n"


def test_a_terminal_has_one_line_that_goes_at_the_end(monkeypatch):
    screen = Screen()
    monkeypatch.setattr("sys.stderr", screen)
    monkeypatch.setenv("COLUMNS", "20")
    with progress.on_stderr() as tell:
        tell("weather")
        tell("a line that is wider than the terminal")
    assert screen.getvalue() == "\r\033[Kopml: weather\r\033[Kopml: a line that i\r\033[K"


def test_items_are_counted_with_the_time_that_is_left():
    told, ticks = [], count(0.0, 30.0)
    items = list(progress.with_time_left(["a", "b", "c"], "morning", told.append, clock=lambda: next(ticks)))
    assert items == ["a", "b", "c"]
    assert told == ["morning 1 of 3", "morning 2 of 3, 60 s left", "morning 3 of 3, 30 s left"]


@pytest.mark.parametrize(
    ("passed", "share", "told"),
    [(10.0, 0.5, "10 s left"), (600.0, 0.25, "30 min left")],
    ids=["short", "long"],
)
def test_long_times_are_told_in_minutes(passed, share, told):
    assert progress.remaining(passed, share) == told


COUNTS = {0: "0 objects", 1: "1 object", 2: "2 objects"}


@pytest.mark.parametrize("number", COUNTS)
def test_one_thing_is_no_plural(number):
    assert progress.counted(number, "object") == COUNTS[number]
