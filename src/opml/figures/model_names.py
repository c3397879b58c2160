"""What a model is, in the few words that a figure has room for."""

from collections.abc import Mapping
from typing import Any

from opml.learning.models.learners import description

SHORT = {
    "refitted": "fit over a longer window",
    "held": "Cd held by its own past",
    "running": "fits with the running mean of Cd",
}
"""Short descriptions of the kinds whose own is too long for a figure."""


def describe_model(settings: Mapping[str, Any]) -> str:
    """Return in a few words what the model of a learner's settings is.

    Raises InputError for an unknown kind.
    """
    kind = settings["kind"]
    words = [SHORT.get(kind) or description(kind).split(" (")[0]]
    if terms := settings.get("terms"):
        words.append(f"{len(terms)} terms")
    if hours := settings.get("window_hours"):
        words.append(f"{hours:g} h")
    if days := settings.get("memory_days"):
        words.append(f"memory {days:g} d")
    return ", ".join(words)
