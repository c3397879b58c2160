"""Spelling of numbers, seeds and alternatives in names."""

import re
from collections.abc import Iterable

# A number in a file name has one spelling: 50, 51.6393, 0.1, but neither 050 nor 0.10.
NUMBER = r"(?:0|[1-9][0-9]*)(?:\.[0-9]*[1-9])?"

POSITIVE = r"(?:0\.[0-9]*[1-9]|[1-9][0-9]*(?:\.[0-9]*[1-9])?)"


def number(value: float) -> str:
    """Return the spelling of a number of at least 0 in a name, to nine decimals: 50, 51.6393, 0.1."""
    return f"{value:.9f}".rstrip("0").rstrip(".")


def alternatives(names: Iterable[str]) -> str:
    """Return the regular expression of any of these names; without names, one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"


NOISE, SPLIT = "noise", "split"  # kinds of seeds: of the measurements, and of the draw of rows and subsamples


def add_seed(text: str, kind: str, seed: int, *, default: int) -> str:
    """Return a name with the suffix of a seed; the run's own seed, `default`, has none."""
    return text if seed == default else f"{text}_{kind}{seed}"


def parse_seed(text: str, kind: str, *, default: int) -> tuple[str, int]:
    """Return a name without the suffix of its seed, and the seed."""
    base, mark, seed = text.partition(f"_{kind}")
    return base, int(seed) if mark else default


def strip_seed(text: str, kind: str) -> str:
    """Return a name without the suffix of its seed."""
    return text.partition(f"_{kind}")[0]


def seed_pattern(kind: str, *, default: int) -> str:
    """Return the regular expression of a seed's suffix, optional, other than `default`."""
    return rf"(?:_{kind}(?!{default}(?!\d))(?:0|[1-9]\d{{0,8}}))?"


DATE = r"[0-9]{4}-[0-9]{2}-[0-9]{2}"  # regular expression of a date, as 2016-09-28
