"""How a model is written in a figure: its name, and in a few words what it is."""

from collections.abc import Mapping
from typing import Any

from opml.learning.models.learners import description

SHORT = {
    "refitted": "fit over a longer window",
    "held": "Cd held by its own past",
    "running": "longer fits, with the running mean of Cd",
}
"""Kinds whose description is too long for a figure."""


def told(settings: Mapping[str, Any]) -> str:
    """What the model of a learner's settings is, in a few words; raises InputError for an unknown kind."""
    kind = settings["kind"]
    words = [SHORT.get(kind) or description(kind).split(" (")[0]]
    if terms := settings.get("terms"):
        words.append(f"{len(terms)} terms")
    if hours := settings.get("window_hours"):
        words.append(f"{hours:g} h")
    return ", ".join(words)
