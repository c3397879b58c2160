"""Suffixes of estimates in names: window, fit, arc, reading of t_b, label."""

import re

from opml.naming.spelling import POSITIVE, number

READINGS = {"kept_estimate": "_kept", "track": "_track"}
"""Suffix for the earlier estimate that is t_b, by the study's `cleaning.previous`."""

LABELS = {"truth": "", "later": "_later"}
"""Suffix for the reference of the errors in training, by the study's `label`."""

MEMBERS = r"[2-9]|[1-9][0-9]{1,2}"  # regular expression of the number of futures of an ensemble

ARC, MEMORY = "_l", "_m"  # beginnings of the suffixes of arcs, and of a memory of the arcs' Cd

ARC_PATTERN, MEMORY_PATTERN = (f"{mark}{POSITIVE}" for mark in (ARC, MEMORY))


def other_reading(previous: str) -> str:
    """Return the suffix of the reading of t_b that the setting `previous` does not choose."""
    return next(suffix for setting, suffix in READINGS.items() if setting != previous)


def parse_reading(suffix: str, *, previous: str) -> str:
    """Return the `cleaning.previous` of a suffix; without a suffix, the setting `previous`."""
    return next((setting for setting, mark in READINGS.items() if mark == suffix), previous)


def window_suffix(hours: float, *, default: float) -> str:
    """Return the suffix of estimates over a window [h]: `''` for the run's own window, `default`."""
    return "" if hours == default else f"_w{number(hours)}"


def parse_window(suffix: str, *, default: float) -> float:
    """Return the estimation window [h] of a suffix; `default` without a suffix."""
    window = re.match(rf"_w({POSITIVE})", suffix)
    return float(window[1]) if window else default


def window_pattern(*, default: float) -> str:
    """Return the regular expression of an estimation window's suffix, optional, other than `default` [h]."""
    return rf"(?:_w(?!{re.escape(number(default))}(?![\d.])){POSITIVE})?"


def number_suffix(mark: str, value: float) -> str:
    """Return the suffix of arcs over a window [h], ARC, or of a memory of their Cd [days], MEMORY."""
    return f"{mark}{number(value)}"


def parse_number(suffix: str) -> float:
    """Return the number in a suffix of arcs or of a memory."""
    return float(suffix[2:])
