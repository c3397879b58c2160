"""Suffixes in the names of files, each of which stands for one setting that differs from the run's own.

`eglin_noise43` is what Eglin measures under another seed, `random-80_split43` another draw of the same
split, `eglin_w24` estimates from 24 hours of tracks, and `svr_s2` the learner `svr` with 2 as its kernel
scale. A suffix that would repeat the run's own setting is no name, so that two names are never the same
thing.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from opml.errors import InputError
from opml.sheets import POSITIVE, Rso, rso_parts, rso_pattern

NOISE, SPLIT = "noise", "split"
"""What has a seed: the measurements, and the draw of rows and subsamples."""

WITHOUT = "-without-"

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
    return rf"(?:_{kind}(?!{default}(?!\d))(?:0|[1-9]\d{{0,8}}))?"


def other_reading(previous: str) -> str:
    """Return the suffix of the reading of t_b that is not the setting's."""
    return next(suffix for setting, suffix in READINGS.items() if setting != previous)


def parse_reading(suffix: str, *, previous: str) -> str:
    """Return the setting `cleaning.previous` that a suffix, or none, stands for."""
    return next((setting for setting, mark in READINGS.items() if mark == suffix), previous)


def windowed(hours: float, *, default: float) -> str:
    """Return the suffix of estimates over another window [h]; none for the run's own, `default`."""
    return "" if hours == default else f"_w{number(hours)}"


def parse_window(suffix: str, *, default: float) -> float:
    """Return the hours of the estimation window that a suffix, or none, stands for."""
    return float(suffix.removeprefix("_w")) if suffix else default


PERFECT = "_true"
"""Suffix of estimates that are the truth itself."""


def window_pattern(*, default: float) -> str:
    """Return the regular expression of an estimation window's suffix, or none."""
    return rf"(?:_w(?!{re.escape(number(default))}(?![\d.])){POSITIVE})?"


def check_split(name: str, *, duration_days: float) -> None:
    """Raise InputError where a split's percentage or days cannot be of a run of so many days."""
    kind, *numbers = name.removesuffix("-unseen").split("-")
    if kind in ("random", "grouped") and not 0.0 < float(numbers[0]) <= 100.0:
        raise InputError(f"split '{name}': expected a percentage above 0 and up to 100, got {numbers[0]}")
    if kind == "days":
        first, last = map(float, numbers)
        if not first < last <= duration_days:
            raise InputError(
                f"split '{name}': expected ascending days up to duration_days, {duration_days:g}, "
                f"got {first:g} and {last:g}"
            )


def learner_pattern(learners: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the regular expression of a learner, its kernel scale overridden if it has one."""
    scaled = [name for name, settings in learners.items() if "kernel_scale" in settings]
    return rf"(?:{'|'.join(learners)}|(?:{'|'.join(scaled)})_s{POSITIVE})"


def parse_learner(text: str, learners: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Return the settings of the learner that a text names. Raises InputError for an unknown text."""
    if not re.fullmatch(learner_pattern(learners), text):
        known = ", ".join(learners)
        raise InputError(f"learner '{text}': expected one of {known}; an svr may end in _s<kernel scale>")
    name, mark, scale = text.partition("_s")
    return dict(learners[name]) | ({"kernel_scale": float(scale)} if mark else {})


def pool_pattern(pools: Iterable[str], sheet: Mapping[str, Rso]) -> str:
    """Return the regular expression of all RSOs of a pool but one, such as `inclinations-without-iss_i50`."""
    return rf"(?:{'|'.join(pools)}){WITHOUT}{rso_pattern(sheet)}"


def parse_pool(text: str, pools: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the RSOs that a pool's name stands for. Raises InputError for an unknown pool."""
    pool, _, left_out = text.partition(WITHOUT)
    if pool not in pools:
        raise InputError(f"pool '{pool}': expected one of {', '.join(pools)}")
    return [rso for rso in pools[pool] if rso != left_out]


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
