"""Suffixes of estimates: window, fit, arc, reading of t_b, label."""

import re

from opml.naming.spelling import POSITIVE, number

LIGHT = "_light"
"""Suffix of estimates whose fits read measurements as received after the light's travel."""

READINGS = {"kept_estimate": "_kept", "track": "_track"}
"""How a name says which earlier estimate is t_b, by the study's `cleaning.previous`."""

LABELS = {"truth": "", "later": "_later", "smoothed": "_smoothed"}
"""How a name says what the errors that are learned from are held against, by the study's `label`."""

MEMBERS = r"[2-9]|[1-9][0-9]{1,2}"
"""Regular expression of how many futures an ensemble has."""

TRACK = r"0|[1-9][0-9]*"
"""Regular expression of the number of a track."""

ARC = f"_l{POSITIVE}_m{POSITIVE}"
"""Regular expression of the suffix of arcs."""

BOTH_SIDES = f"_b{POSITIVE}"
"""Regular expression of the suffix of estimates from tracks on both sides; nothing is predicted from them."""

PERFECT = "_true"
"""Suffix of estimates that are the truth itself."""


def other_reading(previous: str) -> str:
    """Return the suffix of the reading of t_b that is not the setting's."""
    return next(suffix for setting, suffix in READINGS.items() if setting != previous)


def parse_reading(suffix: str, *, previous: str) -> str:
    """Return the `cleaning.previous` that a suffix, or none, stands for."""
    return next((setting for setting, mark in READINGS.items() if mark == suffix), previous)


def windowed(hours: float, *, default: float) -> str:
    """Return the suffix of estimates over another window [h]; none for the run's own, `default`."""
    return "" if hours == default else f"_w{number(hours)}"


def parse_window(suffix: str, *, default: float) -> float:
    """Return the hours of the estimation window that a suffix, or none, stands for; 0 of true states."""
    if suffix == PERFECT:
        return 0.0
    if suffix.startswith("_b"):
        return parse_both_sides(suffix)
    own = re.match(rf"_w({POSITIVE})", suffix)
    return float(own[1]) if own else default


def window_pattern(*, default: float) -> str:
    """Return the regular expression of an estimation window's suffix, or none."""
    return rf"(?:_w(?!{re.escape(number(default))}(?![\d.])){POSITIVE})?"


def fitted(
    *, convergence: float | None = None, cd_sigma: float | None = None, light_time: bool = False
) -> str:
    """Return the suffix of fits that differ from the run's own in these settings."""
    given = {"_tol": convergence, "_cd": cd_sigma}
    marks = [mark + number(value) for mark, value in given.items() if value is not None]
    return "".join(marks) + LIGHT * light_time


def parse_fitted(suffix: str) -> dict[str, float | bool]:
    """Return the settings of the estimation that a suffix of estimates changes, beside its window."""
    found = {
        "convergence": re.search(rf"_tol({POSITIVE})", suffix),
        "cd_sigma": re.search(rf"_cd({POSITIVE})", suffix),
    }
    given = {name: float(match[1]) for name, match in found.items() if match}
    return given | ({"light_time": True} if LIGHT in suffix else {})


def fitted_pattern(*, convergence: float, light_time: bool = False) -> str:
    """Return the regular expression of what `fitted` returns in a run with these settings of its own."""
    stopping = rf"(?:_tol(?!{re.escape(number(convergence))}(?![\d.])){POSITIVE})?"
    return rf"{stopping}(?:_cd{POSITIVE})?" + ("" if light_time else f"(?:{LIGHT})?")


def both_sides(hours: float) -> str:
    """Return the suffix of estimates from tracks up to so many hours before and after each [h]."""
    return f"_b{number(hours)}"


def parse_both_sides(suffix: str) -> float:
    """Return the hours on either side that a suffix stands for; 0 of one that has none after."""
    return float(suffix.removeprefix("_b")) if suffix.startswith("_b") else 0.0


def label_window(label: str, *, hours: float) -> str:
    """Return the suffix of the estimates that a label is made of, in a run with a window of `hours`."""
    return both_sides(hours) if label == LABELS["smoothed"] else ""


def arc(hours: float, memory_days: float) -> str:
    """Return the suffix of what arcs over a window [h] know, with the memory of their Cd [days]."""
    return f"_l{number(hours)}_m{number(memory_days)}"


def parse_arc(suffix: str) -> tuple[float, float]:
    """Return window [h] and memory [days] of a suffix of arcs."""
    hours, days = suffix.removeprefix("_l").split("_m")
    return float(hours), float(days)
