"""What a learner declares and what its models promise: all that the rest of the package knows of a kind."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

import numpy as np
import pandas as pd

from opml.base.setting_types import Absent, Expected, OneOf, Positive, Unique
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
        """The columns of a dataset that it predicts from."""

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Predicted errors (n,) of rows x (n, variables), all in their own units."""


class Model(Predictor, Protocol):
    """What every learner returns: frozen, and the same again when read from its table.

    It predicts row by row: what it says of one does not depend on the others.
    """

    def to_table(self) -> tuple[pd.DataFrame, dict[str, Any]]:
        """The model as a table, and metadata of JSON-able values with its `kind` and `variables`."""


class Fit(Protocol):
    """Train on rows x (n, variables) and target y (n,), both in their own units."""

    def __call__(
        self,
        x: np.ndarray,
        y: np.ndarray,
        *,
        variables: Sequence[str],
        settings: Settings,
        seed: int,
        groups: np.ndarray | None = None,
        weights: np.ndarray | None = None,
    ) -> Model:
        """The model; `groups` (n,) tells which estimate a row belongs to. Raises InputError for bad rows.

        `weights` (n,) are inverse variances of the target's own uncertainty, to a factor, 1 where none are
        given. A squared loss takes them as they are, an absolute one their roots.
        """


class Resolve(Protocol):
    """Settings for one error component, with the `variables` that are learned from spelled out."""

    def __call__(self, settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
        """The resolved settings; `variables` are those to learn from by default."""


Load = Callable[[pd.DataFrame, Metadata], Model]
Table = Callable[[Metadata], Schema]


def own(names: Sequence[str], component: str) -> list[str]:
    """The names of columns, each sensitivity (`v`) as its component's own (`v_y`)."""
    axis = component.removeprefix("e_")
    return [f"{name}_{axis}" if name in MECHANISM_AXES else name for name in names]


def chosen(settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
    """Settings with the variables that they choose by the keys of `CHOICE`, else the default ones."""
    left_out = settings.get("without", [])
    names = [name for name in settings.get("variables", variables) if name not in left_out]
    rest = {key: value for key, value in settings.items() if key != "without"}
    return rest | {"variables": list(dict.fromkeys(own(names, component)))}


def fixed(*names: str) -> Resolve:
    """How settings are resolved that leave no choice of variables."""

    def resolve(settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
        return {**settings, "variables": own(names, component)}

    return resolve


def table_of(row: str, *columns: Column) -> Table:
    """The table of models with the same columns whatever they learned from; `row` says what one row is."""

    def table(described: Metadata) -> Schema:
        return Schema(f"model_{described['kind']}", row, columns)

    return table


ARC_MEMORY_DAYS = 30.0
"""Memory of the arcs' mean Cd where a learner does not ask for another [days]: a turn of the Sun or so."""

_Length = Absent[Positive]

ARC = {"window_hours": _Length, "memory_days": _Length}
"""Keys of learners whose variables may be columns of the `arcs` table, which is made for them."""


class AnyLearner:
    """Type of a setting that holds the settings of another learner, of whatever kind."""


@dataclass(frozen=True)
class Learner:
    """A kind of learner, declared by the module of its model and named once, in `learners.LEARNERS`.

    kind : its name in the settings.
    description : what it is, in words, for the table of models.
    settings : type of each of its own keys (`opml.base.setting_types`); an `Absent` one may be left out.
    table : schema of a model's table, from the metadata beside it; `table_of` makes a plain one.
    fit : trains a model.
    load : makes the model again of its table and metadata, bit for bit.
    resolve : finds the variables to learn from.
    learns : whether it takes anything from the errors that it is trained on.
    """

    kind: str
    description: str
    settings: Mapping[str, Any]
    table: Table
    fit: Fit
    load: Load
    resolve: Resolve = chosen
    learns: bool = True
