"""Two learners in a row: the second learns what the first leaves."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from opml.learning.models.contract import AnyLearner, Learner, Metadata, Model, Settings
from opml.tables import Schema

KIND = "stacked"
PARTS = ("first", "second")


@dataclass(frozen=True, eq=False)
class StackedModel:
    """f(x) = first(x) + second(x), each on its own variables."""

    variables: tuple[str, ...]
    first: Model
    second: Model

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Predicted target (n,) in its own unit for rows x (n, variables) in theirs."""
        first, second = (
            part.predict(_columns(x, self.variables, part.variables)) for part in (self.first, self.second)
        )
        predicted: np.ndarray = first + second
        return predicted

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """The second's table, and metadata of JSON-able values with the whole of the first, a small model."""
        first, first_described = self.first.to_table()
        table, described = self.second.to_table()
        metadata = {
            "kind": KIND,
            "variables": list(self.variables),
            "first": first_described | {"table": first.to_dict("list")},
            "second": described,
        }
        return table, metadata


@dataclass(frozen=True)
class _Stacking:
    """What is done with a stack, by what `by_kind` finds to be done with its parts."""

    by_kind: Callable[[str], Learner]

    def fit(
        self,
        x: np.ndarray,
        y: np.ndarray,
        *,
        variables: Sequence[str],
        settings: Settings,
        seed: int,
        groups: np.ndarray | None = None,
        weights: np.ndarray | None = None,
    ) -> StackedModel:
        """Train the first on y (n,), then the second on what it leaves.

        Each part's settings name its own among the columns of x (n, variables).
        """
        models: list[Model] = []
        for part in (settings[name] for name in PARTS):
            own = _columns(x, variables, part["variables"])
            train = partial(self.by_kind(part["kind"]).fit, seed=seed, groups=groups, weights=weights)
            models.append(train(own, y, variables=part["variables"], settings=part))
            y = y - models[-1].predict(own)
        return StackedModel(tuple(variables), *models)

    def load(self, table: pd.DataFrame, metadata: Metadata) -> StackedModel:
        """The model that `to_table` wrote, bit for bit."""
        first, second = (metadata[name] for name in PARTS)
        return StackedModel(
            tuple(metadata["variables"]),
            self.by_kind(first["kind"]).load(pd.DataFrame(first["table"]), first),
            self.by_kind(second["kind"]).load(table, second),
        )

    def table(self, described: Metadata) -> Schema:
        """The schema of the second's table."""
        second = described["second"]
        return self.by_kind(second["kind"]).table(second)

    def resolve(self, settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
        """Settings with both parts resolved; their variables together, each once."""
        parts = {
            name: self.by_kind(part["kind"]).resolve(part, component=component, variables=variables)
            for name, part in ((name, settings[name]) for name in PARTS)
        }
        names = [name for part in parts.values() for name in part["variables"]]
        return {**settings, **parts, "variables": list(dict.fromkeys(names))}


def learner(by_kind: Callable[[str], Learner]) -> Learner:
    """The stack of any two of the learners that `by_kind` finds."""
    stacking = _Stacking(by_kind)
    return Learner(
        kind=KIND,
        description="robust linear law, then another learner on what it leaves",
        settings=dict.fromkeys(PARTS, AnyLearner),
        table=stacking.table,
        fit=stacking.fit,
        load=stacking.load,
        resolve=stacking.resolve,
    )


def _columns(x: np.ndarray, variables: Sequence[str], names: Sequence[str]) -> np.ndarray:
    return np.asarray(x)[:, [list(variables).index(name) for name in names]]
