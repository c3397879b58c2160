"""How numbers, seeds and choices are spelt in a name."""

import re
from collections.abc import Iterable

# One spelling per number, as it is part of file names: 50, 51.6393, 0.1, but neither 050 nor 0.10.
NUMBER = r"(?:0|[1-9][0-9]*)(?:\.[0-9]*[1-9])?"

POSITIVE = r"(?:0\.[0-9]*[1-9]|[1-9][0-9]*(?:\.[0-9]*[1-9])?)"


def number(value: float) -> str:
    """Return the one spelling of a number from 0 in a name, to nine decimals: 50, 51.6393, 0.1."""
    return f"{value:.9f}".rstrip("0").rstrip(".")


def any_of(names: Iterable[str]) -> str:
    """Return the regular expression of some names; of none, one that nothing matches."""
    return "|".join(map(re.escape, names)) or "(?!)"


NOISE, SPLIT = "noise", "split"
"""What has a seed: the measurements, and the draw of rows and subsamples."""


def seeded(text: str, kind: str, seed: int, *, default: int) -> str:
    """Return the name of `text` under a seed; under the run's own seed, `default`, it is the text itself."""
    return text if seed == default else f"{text}_{kind}{seed}"


def parse_seed(text: str, kind: str, *, default: int) -> tuple[str, int]:
    """Return what a name says without its seed, and the seed."""
    base, mark, seed = text.partition(f"_{kind}")
    return base, int(seed) if mark else default


def without_seed(text: str, kind: str) -> str:
    """Return what a name says without its seed."""
    return text.partition(f"_{kind}")[0]


def seed_pattern(kind: str, *, default: int) -> str:
    """Return the regular expression of a seed's suffix, or none."""
    return rf"(?:_{kind}(?!{default}(?!\d))(?:0|[1-9]\d{{0,8}}))?"
