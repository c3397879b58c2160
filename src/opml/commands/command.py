"""A subcommand, and what the arguments of several have in common."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass

from opml.base.errors import InputError

WEATHER = "space weather, CSSI (that of `opml fetch`, else that of the package)"
UTC_TEXT = "UTC, as 2026-07-15 or 2026-07-15T06:00:00Z"


def instant(text: str) -> str:
    """Return UTC text, as `epochs.instant`, which is imported when it is needed."""
    from opml.base import epochs

    return epochs.instant(text)


LATENCY = "hours from epoch to publication of sets that do not say it (6; 0 without --date)"


def latency(options: argparse.Namespace) -> float:
    """Return days from epoch to publication by --latency and --date. Raises InputError for less than 0."""
    from opml.interop.element_sets import known_sets

    if options.latency is None:
        return 0.0 if options.date is None else known_sets.LATENCY
    if not options.latency >= 0.0:
        raise InputError(f"--latency: expected 0 hours or more, got {options.latency:g}")
    return float(options.latency / 24.0)


@dataclass(frozen=True)
class Command:
    """A subcommand: its line in the help, its arguments, and the function that runs it and prints."""

    name: str
    help: str
    add_arguments: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], None]
