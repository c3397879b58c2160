"""Two learners in a row: the second learns what the first leaves."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import create_model

from opml.base.kind_sections import OfItsKind
from opml.learning.models.contract import Learner, LearnerSettings, Metadata, Model, ResolvedSettings
from opml.learning.models.training_inputs import Training, pick_columns
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
        """Return the predicted target (n,) for rows x (n, variables), all in their own units."""
        first, second = (
            part.predict(pick_columns(x, self.variables, part.variables))
            for part in (self.first, self.second)
        )
        return first + second

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return the table of the second, and metadata with all of the first, which is a small model."""
        first, first_described = self.first.to_table()
        table, described = self.second.to_table()
        metadata = {
            "kind": KIND,
            "variables": list(self.variables),
            "first": first_described | {"table": first.to_dict("list")},
            "second": described,
        }
        return table, metadata


class StackedSettings(LearnerSettings):
    first: LearnerSettings
    second: LearnerSettings


def fit(
    training: Training,
    parts: Mapping[str, ResolvedSettings],
    fit_part: Callable[[Training, ResolvedSettings], Model],
) -> StackedModel:
    """Train the first, then the second on what the first leaves, each on its own variables."""
    models: list[Model] = []
    for part in (parts[name] for name in PARTS):
        narrowed = training.narrow(part.variables)
        models.append(fit_part(narrowed, part))
        training = replace(training, y=training.y - models[-1].predict(narrowed.x))
    return StackedModel(tuple(training.variables), *models)


@dataclass(frozen=True)
class _Stacking:
    """What a learner declares, for a stack whose parts `by_kind` finds."""

    by_kind: Callable[[str], Learner[Any]]

    def load(self, table: pd.DataFrame, metadata: Metadata) -> StackedModel:
        """Return the model that `to_table` wrote, bit for bit."""
        first, second = (metadata[name] for name in PARTS)
        return StackedModel(
            tuple(metadata["variables"]),
            self.by_kind(first["kind"]).load(pd.DataFrame(first["table"]), first),
            self.by_kind(second["kind"]).load(table, second),
        )

    def table(self, metadata: Metadata) -> Schema:
        """Return the schema of the table of the second."""
        second = metadata["second"]
        return self.by_kind(second["kind"]).table(second)

    def resolve(
        self, settings: StackedSettings, /, *, component: str, variables: Sequence[str]
    ) -> ResolvedSettings:
        """Return settings with both parts resolved, and the variables of both, each once."""
        parts = {
            name: self.by_kind(part.kind).resolve(part, component=component, variables=variables)
            for name, part in zip(PARTS, (settings.first, settings.second), strict=True)
        }
        names = [name for part in parts.values() for name in part.variables]
        return ResolvedSettings(settings, list(dict.fromkeys(names)), parts)


def learner(by_kind: Callable[[str], Learner[Any]], kinds: OfItsKind) -> Learner[StackedSettings]:
    """Return the stack of any two of the learners that `by_kind` finds; kinds: of the settings of a part."""
    stacking = _Stacking(by_kind)
    part: Any = (Annotated[LearnerSettings, kinds], ...)
    return Learner(
        kind=KIND,
        description="robust linear law, then another learner on its residuals",
        settings=create_model(KIND, __base__=StackedSettings, first=part, second=part),
        table=stacking.table,
        fit=None,
        load=stacking.load,
        resolve=stacking.resolve,
    )
