"""A subcommand, and what the arguments of several have in common."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass

WEATHER = "space weather, CSSI (that of `opml fetch`, else that of the package)"
UTC_TEXT = "UTC, as 2026-07-15 or 2026-07-15T06:00:00Z"


def instant(text: str) -> str:
    """Return UTC text, as `epochs.instant`, which is imported when it is needed."""
    from opml.base import epochs

    return epochs.instant(text)


@dataclass(frozen=True)
class Command:
    """A subcommand: its line in the help, its arguments, and the function that runs it and prints."""

    name: str
    help: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], None]
