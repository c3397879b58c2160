"""Two learners in a row: the second learns what the first leaves."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.learning.evaluation import Model


@dataclass(frozen=True, eq=False)
class StackedModel:
    """f(x) = first(x) + second(x), each on its own variables."""

    variables: tuple[str, ...]
    first: Model
    second: Model

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Predicted target (n,) in its own unit for rows x (n, variables) in theirs."""
        parts = (self.first, self.second)
        return sum(part.predict(_columns(x, self.variables, part.variables)) for part in parts)

    def to_table(self) -> tuple[pd.DataFrame, dict]:
        """The second's table, and metadata of JSON-able values with the whole of the first, a small model."""
        first, first_described = self.first.to_table()
        table, described = self.second.to_table()
        metadata = {
            "kind": "stacked",
            "variables": list(self.variables),
            "first": first_described | {"table": first.to_dict("list")},
            "second": described,
        }
        return table, metadata


def fit(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Mapping,
    seed: int,
    groups: np.ndarray | None = None,
    train: Callable[..., Model],
) -> StackedModel:
    """Train `settings['first']` on y (n,), then `settings['second']` on what it leaves, both by `train`.

    Each part's settings name its own among the columns of x (n, variables).
    """
    models: list[Model] = []
    for part in (settings["first"], settings["second"]):
        own = _columns(x, variables, part["variables"])
        models.append(train(own, y, variables=part["variables"], settings=part, seed=seed, groups=groups))
        y = y - models[-1].predict(own)
    return StackedModel(tuple(variables), *models)


def from_table(
    table: pd.DataFrame, metadata: Mapping, *, load: Callable[[pd.DataFrame, Mapping], Model]
) -> StackedModel:
    """The model that `to_table` wrote, bit for bit; `load` reads each part."""
    first = load(pd.DataFrame(metadata["first"]["table"]), metadata["first"])
    return StackedModel(tuple(metadata["variables"]), first, load(table, metadata["second"]))


def _columns(x: np.ndarray, variables: Sequence[str], names: Sequence[str]) -> np.ndarray:
    return np.asarray(x)[:, [list(variables).index(name) for name in names]]
