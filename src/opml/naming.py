"""Suffixes in the names of files, each of which stands for one setting that differs from the run's own.

`eglin_noise43` is what Eglin measures under another seed, `random-80_split43` another draw of the same
split, and `svr_s2` the learner `svr` with 2 as its kernel scale. A suffix that would repeat the run's own
seed is no name, so that two names are never the same thing.
"""

import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from opml.errors import InputError
from opml.sheets import POSITIVE, Rso, rso_parts

NOISE, SPLIT = "noise", "split"
"""What has a seed: the measurements, and the draw of rows and subsamples."""

READINGS = {"kept_estimate": "_kept", "track": "_track"}
"""How a name says which earlier estimate is t_b, by the setting `cleaning.previous`."""


def number(value: float) -> str:
    """Return the one spelling of a number from 0 in a name, to nine decimals: 50, 51.6393, 0.1."""
    return f"{value:.9f}".rstrip("0").rstrip(".")


def seeded(text: str, kind: str, seed: int, *, default: int) -> str:
    """Return the name of `text` under a seed; that of the run's own seed, `default`, is the text itself."""
    return text if seed == default else f"{text}_{kind}{seed}"


def parse_seed(text: str, kind: str, *, default: int) -> tuple[str, int]:
    """Return what a name says without its seed, and the seed."""
    base, mark, seed = text.partition(f"_{kind}")
    return base, int(seed) if mark else default


def seed_pattern(kind: str, *, default: int) -> str:
    """Return the regular expression of a seed's suffix, or none."""
    return rf"(?:_{kind}(?!{default}(?!\d))(?:0|[1-9]\d*))?"


def other_reading(previous: str) -> str:
    """Return the suffix of the reading of t_b that is not the setting's."""
    return next(suffix for setting, suffix in READINGS.items() if setting != previous)


def parse_reading(suffix: str, *, previous: str) -> str:
    """Return the setting `cleaning.previous` that a suffix, or none, stands for."""
    return next((setting for setting, mark in READINGS.items() if mark == suffix), previous)


def learner_pattern(learners: Iterable[str]) -> str:
    """Return the regular expression of a learner, its kernel scale overridden or not."""
    return rf"(?:{'|'.join(learners)})(?:_s{POSITIVE})?"


def parse_learner(text: str, learners: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the settings of the learner that a text names. Raises InputError for an unknown text."""
    if not re.fullmatch(learner_pattern(learners), text):
        known = ", ".join(learners)
        raise InputError(f"learner '{text}': expected one of {known}, then at most _s<kernel scale>")
    name, mark, scale = text.partition("_s")
    return dict(learners[name]) | ({"kernel_scale": float(scale)} if mark else {})


def with_inclination(text: str, degrees: float, sheet: Mapping[str, Rso]) -> str:
    """Return the name of an RSO at another inclination; at the sheet's own it is the RSO itself."""
    base, _, offset = rso_parts(text, sheet)
    return _varied(base, "" if math.radians(degrees) == sheet[base].i else number(degrees), offset)


def with_offset(text: str, km: float, sheet: Mapping[str, Rso]) -> str:
    """Return the name of an RSO with `km` added to its sheet's semi-major axis."""
    base, inclination, _ = rso_parts(text, sheet)
    return _varied(base, inclination, f"{'-' if km < 0 else '+'}{number(abs(km))}" if km else "")


def _varied(base: str, inclination: str, offset: str) -> str:
    return base + (f"_i{inclination}" if inclination else "") + (f"_a{offset}" if offset else "")
