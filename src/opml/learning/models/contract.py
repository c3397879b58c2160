"""What a learner declares and what its models promise: all that the rest of the package knows of a kind."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

import numpy as np
import pandas as pd

from opml.base.setting_types import Absent, Expected, OneOf, Positive, Unique
from opml.learning.models.inputs import Training
from opml.tables import LEARNING_VARIABLES, MECHANISM_AXES, Column, Schema

Settings = Mapping[str, Any]
Metadata = Mapping[str, Any]

Variable = Annotated[str, OneOf((*LEARNING_VARIABLES, "gap"))]
"""Type of a setting that is a learning variable."""

_Chosen = Absent[
    Annotated[list[str], Unique(), Expected("a list of learning variables or columns of the mechanism")]
]
_LeftOut = Absent[Annotated[list[Variable], Unique()]]

CHOICE = {"variables": _Chosen, "without": _LeftOut}
"""Keys by which settings may choose variables: those to learn from, or those of the default to leave out."""


class Predictor(Protocol):
    """What corrects rows of a dataset."""

    @property
    def variables(self) -> tuple[str, ...]:
        """Columns of a dataset that it predicts from."""

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Return predicted errors (n,) of rows x (n, variables), all in their own units."""


class Model(Predictor, Protocol):
    """What every learner returns: frozen, and the same again when read from its table.

    It predicts row by row: the prediction of a row does not depend on the other rows.
    """

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return the model as a table, and JSON-able metadata with its `kind` and `variables`."""


class Resolve(Protocol):
    """Resolves settings for one error component."""

    def __call__(self, settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
        """Return the settings with the `variables` to learn from spelled out.

        variables: those to learn from by default
        """


Fit = Callable[[Training, Settings], Model]
Load = Callable[[pd.DataFrame, Metadata], Model]
Table = Callable[[Metadata], Schema]


def component_columns(names: Sequence[str], component: str) -> list[str]:
    """Return names of columns with the component's axis on each sensitivity: `v` becomes `v_y` for `e_y`."""
    axis = component.removeprefix("e_")
    return [f"{name}_{axis}" if name in MECHANISM_AXES else name for name in names]


def choose_variables(settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
    """Return settings with the variables that the keys of `CHOICE` choose, else the default ones."""
    left_out = settings.get("without", [])
    names = [name for name in settings.get("variables", variables) if name not in left_out]
    rest = {key: value for key, value in settings.items() if key != "without"}
    return rest | {"variables": list(dict.fromkeys(component_columns(names, component)))}


def fixed(*names: str, **beside: Any) -> Resolve:
    """Return how settings are resolved that leave no choice of variables; beside: further settings."""

    def resolve(settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
        return {**settings, **beside, "variables": component_columns(names, component)}

    return resolve


def table_of(row: str, *columns: Column) -> Table:
    """Return the table of models that have the same columns whatever they learned from.

    row: what one row of the table is, in words
    """

    def table(metadata: Metadata) -> Schema:
        return Schema(f"model_{metadata['kind']}", row, columns)

    return table


ARC_MEMORY_DAYS = 30.0
"""Memory of the arcs' mean Cd where a learner does not ask for another [days]: about a turn of the Sun."""

WHOLE_PAST = math.inf
"""Window of the arcs of a sequential filter [h]."""

_SETTLED = 48.0

_Length = Absent[Positive]

ARC = {"window_hours": _Length, "memory_days": _Length}
"""Keys of learners whose variables may be columns of the tables of arcs, which are made for them."""


def hours_to_fill(window_hours: float) -> float:
    """Return after how many hours of tracks a window is full, or a filter has forgotten how it began."""
    return _SETTLED if math.isinf(window_hours) else window_hours


class AnyLearner:
    """Type of a setting that holds the settings of another learner, of whatever kind."""


@dataclass(frozen=True)
class Learner:
    """A kind of learner, declared by the module of its model and named once, in `learners.LEARNERS`.

    kind: its name in the settings
    description: what it is, in words, for the table of models
    settings: type of each of its own keys (`opml.base.setting_types`); an `Absent` one may be left out
    table: returns the schema of a model's table from the metadata beside it; `table_of` makes a plain one
    fit: trains a model; raises InputError for rows that it cannot learn from
    load: makes the model again from its table and metadata, bit for bit
    resolve: finds the variables to learn from
    learns: whether it takes anything from the errors that it is trained on
    """

    kind: str
    description: str
    settings: Mapping[str, Any]
    table: Table
    fit: Fit
    load: Load
    resolve: Resolve = choose_variables
    learns: bool = True
