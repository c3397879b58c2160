"""The numbers of a model that go with its table, as JSON-able values and back."""

from typing import Any

import numpy as np

from opml.learning.models.contract import Metadata, Predictor


def describe(model: Predictor, kind: str, *fields: str) -> dict[str, Any]:
    """Return the metadata of a model: kind, variables and these of its fields, arrays as lists."""
    values = {name: getattr(model, name) for name in fields}
    lists = {name: value.tolist() for name, value in values.items() if isinstance(value, np.ndarray)}
    return {"kind": kind, "variables": list(model.variables), **values, **lists}


def restore(metadata: Metadata, *fields: str) -> dict[str, Any]:
    """Return `variables` and these fields of a model from its metadata, lists as arrays of floats."""
    values = {name: metadata[name] for name in fields}
    arrays = {name: np.array(value, dtype=float) for name, value in values.items() if isinstance(value, list)}
    return {"variables": tuple(metadata["variables"]), **values, **arrays}
