"""Short descriptions of models, for figures."""

from collections.abc import Sequence

from opml.learning.models.contract import LearnerSettings
from opml.learning.models.learners import description

SHORT = {"refitted": "fit over a longer window", "running": "fits with the running mean of Cd"}
"""Short descriptions of the kinds whose own is too long for a figure."""

_LISTED = 3  # terms of a law that are named, where there are no more


def describe_model(settings: LearnerSettings) -> str:
    """Return in a few words what the model of a learner's settings is."""
    words = [SHORT.get(settings.kind) or description(settings.kind).split(" (")[0]]
    if isinstance(scale := settings.get("kernel_scale"), float):
        words.append(f"kernel scale {scale:g}")
    if terms := settings.get("terms"):
        words.append(_few(terms) if len(terms) <= _LISTED else f"{len(terms)} terms")
    if hours := settings.get("window_hours"):
        words.append(f"{hours:g} h")
    if days := settings.get("memory_days"):
        words.append(f"memory {days:g} d")
    return ", ".join(words)


def _few(terms: Sequence[str]) -> str:
    """Return terms in a row, each as a product: `duration², duration² cd`."""
    return ", ".join(
        term.replace("duration*duration", "duration\N{SUPERSCRIPT TWO}").replace("*", " ") for term in terms
    )
