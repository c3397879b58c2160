"""What became of objects on a day, in a file; pages are made of it without what mornings need to run."""

import json
from pathlib import Path
from typing import Any

from opml.base.files import FilePath, replacing

GOOD, UNPROVEN, WIDE, DO_NOT_USE = "good", "unproven", "wide", "do not use"
"""Verdicts."""

FAILED = "failed"
"""The verdict where a morning could not be run."""

NOTHING: dict[str, Any] = {
    "model": None,
    "message": None,
    "newest_estimate": None,
    "age_hours": None,
    "burn": None,
    "tracks": 0,
    "converged": 0,
    "late": 0,
    "expected": [],
    "scores": [],
    "past": {},
    "mornings": [],
    "beside_sgp4": [],
}
"""What is told of a morning that could not be run, and where an older release told nothing."""


def write(path: FilePath, outcomes: Any) -> None:
    """Write what became of objects as JSON."""
    with replacing(path) as temporary:
        text = json.dumps(outcomes, separators=(",", ":"), allow_nan=False)
        temporary.write_text(f"{text}\n", encoding="utf-8")


def read(path: FilePath) -> list[dict[str, Any]]:
    """Return what became of objects, of mornings by an older release, too."""
    found: list[dict[str, Any]] = json.loads(Path(path).read_text(encoding="utf-8"))
    return [whole(outcome) for outcome in found]


def whole(outcome: dict[str, Any]) -> dict[str, Any]:
    """Return what became of an object, with what an older release told nothing of."""
    return outcome | {key: value for key, value in NOTHING.items() if key not in outcome}
