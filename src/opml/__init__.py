"""Orbit prediction improved by machine learning: a simulated catalogue, and its predictions corrected.

The names in `__all__` are the library's face, each documented in `opml.api`, and are imported at
first use.
"""

from importlib import import_module
from typing import Any

__version__ = "1.0.0"

__all__ = [
    "ASSUMED",
    "CLEANING",
    "ESTIMATION",
    "LEARNER",
    "TRUTH",
    "Catalogue",
    "Environment",
    "InputError",
    "Integrator",
    "KnownOrbit",
    "Prediction",
    "Propagator",
    "Rso",
    "Station",
    "compare",
    "correct",
    "dataset",
    "estimate",
    "first_orbit",
    "force_model",
    "label",
    "learn",
    "make_environment",
    "p_ml",
    "predict",
    "predict_tracks",
    "propagate",
    "read_orbit",
    "read_rsos",
    "read_stations",
    "read_tracks",
    "style",
    "track",
]


def __getattr__(name: str) -> Any:
    # By name, not by an import statement: provenance would count the whole package to every rule's code.
    if name not in __all__:
        raise AttributeError(f"module 'opml' has no attribute '{name}'")
    return getattr(import_module("opml.api"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
