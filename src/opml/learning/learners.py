"""The learners by `kind`: the one place to add another to.

A learner is a module-level `fit(x, y, *, variables, settings, seed, groups)` that returns a frozen model with
`variables`, `predict(x)`, `to_table()` and the class method `from_table(table, metadata)`.
"""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from opml.errors import InputError
from opml.learning import svr
from opml.learning.evaluation import Model

FITS = {"svr": svr.fit}
MODELS = {"svr": svr.SvrModel}


def fit(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Mapping,
    seed: int,
    groups: np.ndarray | None = None,
) -> Model:
    """Train the learner that `settings['kind']` names; raises InputError for an unknown kind."""
    train = _by_kind(FITS, settings["kind"])
    return train(x, y, variables=variables, settings=settings, seed=seed, groups=groups)


def from_table(table: pd.DataFrame, metadata: Mapping) -> Model:
    """The model of a saved table, whatever its kind; raises InputError for an unknown kind."""
    return _by_kind(MODELS, metadata["kind"]).from_table(table, metadata)


def _by_kind(table: Mapping, kind: str) -> object:
    if kind not in table:
        raise InputError(f"learners: kind: expected {', '.join(table)}, got {kind}")
    return table[kind]
