"""Suffixes of estimates in names: window, fit, arc, reading of t_b, label."""

import re

from opml.naming.spelling import POSITIVE, number

READINGS = {"kept_estimate": "_kept", "track": "_track"}
"""Suffix for the earlier estimate that is t_b, by the study's `cleaning.previous`."""

LABELS = {"truth": "", "later": "_later"}
"""Suffix for the reference of the errors in training, by the study's `label`."""

MEMBERS = r"[2-9]|[1-9][0-9]{1,2}"  # regular expression of the number of futures of an ensemble

ARC_PATTERN = f"_l{POSITIVE}"  # regular expression of the suffix of arcs

MEMORY_PATTERN = f"_m{POSITIVE}"  # regular expression of the suffix of a memory of the arcs' Cd


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


def arc_suffix(hours: float) -> str:
    """Return the suffix of arcs over a window [h]."""
    return f"_l{number(hours)}"


def parse_arc(suffix: str) -> float:
    """Return the window [h] of a suffix of arcs."""
    return float(suffix.removeprefix("_l"))


def memory_suffix(days: float) -> str:
    """Return the suffix of a memory of the arcs' Cd [days]."""
    return f"_m{number(days)}"


def parse_memory(suffix: str) -> float:
    """Return the memory [days] of a suffix."""
    return float(suffix.removeprefix("_m"))
