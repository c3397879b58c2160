"""The interface of learners and of their models: all that the rest of the package knows of a kind."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, Protocol, TypeVar

import numpy as np
import pandas as pd

from opml.base.section import Section
from opml.base.setting_types import Absent, Expected, OneOf, Unique
from opml.learning.models.training_inputs import Training
from opml.tables import LEARNING_VARIABLES, MECHANISM_AXES, Column, Schema

Metadata = Mapping[str, Any]

Variable = Annotated[str, OneOf((*LEARNING_VARIABLES, "gap"))]
"""Type of a setting that is a learning variable."""

_Chosen = Absent[
    Annotated[list[str], Unique(), Expected("a list of learning variables or columns of the mechanism")]
]
_LeftOut = Absent[Annotated[list[Variable], Unique()]]


class LearnerSettings(Section):
    """Settings of a learner; those of its kind follow `kind`."""

    columns: ClassVar[tuple[str, ...]] = ()  # that the kind learns from, where there is no choice

    kind: str

    def get(self, key: str) -> Any:
        """Return a setting, None where it was left out or the kind has none of this name."""
        return getattr(self, key, None)

    def of_job(self) -> dict[str, Any]:
        """Return the settings that were given, as JSON values."""
        return self.model_dump(exclude_unset=True)

    def resolved(self, *, component: str, variables: Sequence[str]) -> "ResolvedSettings":
        """Return the settings for an error component; variables: to learn from where nothing else is said."""
        return ResolvedSettings(self, component_columns(self.columns, component))


class ChoosingSettings(LearnerSettings):
    """Settings that may choose variables: those to learn from, or those of the default to leave out."""

    variables: _Chosen = None
    without: _LeftOut = None

    def resolved(self, *, component: str, variables: Sequence[str]) -> "ResolvedSettings":
        """Return the settings for an error component, with the variables that they choose."""
        left_out = self.without or ()
        wanted = variables if self.variables is None else self.variables
        names = [name for name in wanted if name not in left_out]
        own = {key: value for key, value in self.of_job().items() if key not in ("variables", "without")}
        chosen = list(dict.fromkeys(component_columns(names, component)))
        return ResolvedSettings(type(self).model_validate(own), chosen)


@dataclass(frozen=True)
class ResolvedSettings:
    """Settings of a learner for one error component."""

    own: LearnerSettings  # those of its kind
    variables: list[str]  # columns of a dataset that it learns from

    def of_job(self) -> dict[str, Any]:
        """Return them as JSON values, which `learners.of_job` takes."""
        return {**self.own.of_job(), "variables": self.variables}


S = TypeVar("S", bound=LearnerSettings)


class Model(Protocol):
    """A trained model of any kind: frozen, and the same again when read from its table.

    It predicts row by row: the prediction of a row does not depend on the other rows.
    """

    @property
    def variables(self) -> tuple[str, ...]:
        """Columns of a dataset that it predicts from."""

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return predicted errors (n,) of rows x (n, variables), all in their own units."""

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return the model as a table, and JSON-able metadata with its `kind` and `variables`."""


Load = Callable[[pd.DataFrame, Metadata], Model]
Table = Callable[[Metadata], Schema]


def component_columns(names: Sequence[str], component: str) -> list[str]:
    """Return names of columns with the component's axis on each sensitivity: `v` becomes `v_y` for `e_y`."""
    axis = component.removeprefix("e_")
    return [f"{name}_{axis}" if name in MECHANISM_AXES else name for name in names]


def table_of(row: str, *columns: Column) -> Table:
    """Return the table of models that have the same columns whatever they learned from.

    row: what one row of the table is, in words
    """

    def table(metadata: Metadata) -> Schema:
        return Schema(f"model_{metadata['kind']}", row, columns)

    return table


def describe(model: Model, kind: str, *fields: str) -> dict[str, Any]:
    """Return the metadata of a model: kind, variables and these of its fields, arrays as lists."""
    values = {name: getattr(model, name) for name in fields}
    lists = {name: value.tolist() for name, value in values.items() if isinstance(value, np.ndarray)}
    return {"kind": kind, "variables": list(model.variables), **values, **lists}


def restore(metadata: Metadata, *fields: str) -> dict[str, Any]:
    """Return `variables` and these fields of a model from its metadata, lists as arrays of floats."""
    values = {name: metadata[name] for name in fields}
    arrays = {name: np.array(value, dtype=float) for name, value in values.items() if isinstance(value, list)}
    return {"variables": tuple(metadata["variables"]), **values, **arrays}


ARC_MEMORY_DAYS = 30.0
"""Memory of the arcs' mean Cd where a learner does not ask for another [days]: about a turn of the Sun."""


@dataclass(frozen=True)
class Learner(Generic[S]):
    """A kind of learner, declared by the module of its model and named once, in `learners.LEARNERS`."""

    kind: str  # its name in the settings
    description: str  # in words, for the table of models
    settings: type[S]  # section of its settings
    table: Table  # the schema of a model's table from the metadata with it; `table_of` makes a plain one
    fit: Callable[[Training, S], Model]
    load: Load  # makes the model again from its table and metadata, bit for bit
    learns: bool = True  # whether it takes anything from the errors that it is trained on
