"""What became of objects on a day, in a file; pages are made of it without what mornings need to run."""

import json
from pathlib import Path
from typing import Any

from opml.base.files import FilePath, replacing

GOOD, UNPROVEN, WIDE, DO_NOT_USE = "good", "unproven", "wide", "do not use"
"""Verdicts."""

FAILED = "failed"
"""The verdict where a morning could not be run."""


def write(path: FilePath, outcomes: Any) -> None:
    """Write what became of objects as JSON."""
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(outcomes, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def read(path: FilePath) -> list[dict[str, Any]]:
    """Return what became of objects."""
    return json.loads(Path(path).read_text(encoding="utf-8"))
