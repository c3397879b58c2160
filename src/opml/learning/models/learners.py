"""The learners by `kind`, and what can be done with any of them.

A kind is declared by a `Learner` in its own module and named in `LEARNERS`; docs/howto.md shows how.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from typing import Any, TypeVar

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.learning.models import (
    boosting,
    duration_mean,
    fixed_laws,
    linear_law,
    stacked,
    svr,
)
from opml.learning.models.contract import ARC_MEMORY_DAYS, Learner, Metadata, Model, Settings
from opml.learning.models.inputs import Training
from opml.tables import (
    COMPONENTS,
    LEARNING_VARIABLES,
    SCHEMAS,
    Schema,
    mechanism_schema,
    read_metadata,
    read_table,
)

Path = TypeVar("Path")

LEARNERS: tuple[Learner, ...] = (
    svr.LEARNER,
    fixed_laws.NONE,
    duration_mean.LEARNER,
    fixed_laws.REPREDICTED,
    linear_law.LEARNER,
    boosting.LEARNER,
    fixed_laws.REFITTED,
    fixed_laws.HELD,
    fixed_laws.RUNNING,
    fixed_laws.FILTERED,
    fixed_laws.FILTERED_MEAN,
    fixed_laws.SGP4,
    fixed_laws.DENSITY,
    fixed_laws.LEARNED,
)
"""The kinds that stand alone. Any two of them make a stack."""

ARC_TABLES = ("arcs", "cd_past", "held")
"""Kinds of tables beside the dataset that are made for the window, and the memory, of a learner's arcs."""

_BESIDE = ("oracle", *ARC_TABLES, "sgp4", "improved")
"""Kinds of tables beside the dataset with columns of their own; all other columns are the mechanism's."""


def by_kind(kind: str) -> Learner:
    """Return the learner of a kind; raise InputError for an unknown one."""
    known = _by_kind()
    if kind not in known:
        raise InputError(f"learners: kind: expected {', '.join(known)}, got {kind}")
    return known[kind]


def description(kind: str) -> str:
    """Return what a kind of learner is, in words; raise InputError for an unknown kind."""
    return by_kind(kind).description


def learns(settings: Settings) -> bool:
    """Return whether the learner takes anything from errors; raise InputError for an unknown kind."""
    return by_kind(settings["kind"]).learns


def settings_types() -> dict[str, Mapping[str, Any]]:
    """Return the type of each key that the settings of a kind have beside `kind`, by kind."""
    return {kind: learner.settings for kind, learner in _by_kind().items()}


def fit(training: Training, settings: Settings) -> Model:
    """Train the learner that `settings['kind']` names; raise InputError for an unknown kind."""
    return by_kind(settings["kind"]).fit(training, settings)


def train(rows: pd.DataFrame, *, component: str, settings: Settings, seed: int) -> Model:
    """Train a learner on rows of a dataset for one error component.

    settings: as `resolved` returns them

    Raises InputError as `Training.from_rows` and `fit` do.
    """
    return fit(Training.from_rows(rows, settings["variables"], component=component, seed=seed), settings)


def read(path: str | PathLike[str]) -> Model:
    """Read a model; raise InputError for a file that is missing or damaged, or whose parts do not fit."""
    described = read_metadata(path)
    with _naming(path):
        columns = schema(described)
    table = read_table(path, columns)
    with _naming(path):
        model = from_table(table, described)
        # The file may come from elsewhere: one row shows whether its parts fit each other.
        with np.errstate(all="ignore"):
            tried = model.predict(np.zeros((1, len(model.variables))))
        if tried.shape != (1,) or not np.isfinite(tried).all():
            raise ValueError(f"predicts {tried}")
    return model


@contextmanager
def _naming(path: str | PathLike[str]) -> Iterator[None]:
    """Turn any error in a model's metadata or numbers into one line with the path of its file."""
    try:
        yield
    except (InputError, LookupError, TypeError, ValueError) as reason:
        raise InputError(f"{path}: expected a model whose parts fit each other, got {reason!r}") from None


def from_table(table: pd.DataFrame, metadata: Metadata) -> Model:
    """Return the model of a saved table, whatever its kind; raise InputError for an unknown kind."""
    return by_kind(metadata["kind"]).load(table, metadata)


def schema(metadata: Metadata) -> Schema:
    """Return the schema of a model's table from its metadata; raise InputError for an unknown kind."""
    return by_kind(metadata["kind"]).table(metadata)


def schemas() -> list[Schema]:
    """Return the tables of models of all learning variables; a stack has the table of its second part."""
    return [learner.table({"kind": learner.kind, "variables": LEARNING_VARIABLES}) for learner in LEARNERS]


def resolved(settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
    """Return the settings of a learner for one error component, with its `variables` spelled out.

    variables: of a learner whose settings name none; its `without` are left out

    A sensitivity (`v`) becomes that of the component (`v_y`), in variables and terms alike. Raises InputError
    for an unknown kind.
    """
    return by_kind(settings["kind"]).resolve(settings, component=component, variables=variables)


def arc_of(settings: Settings) -> tuple[float, float] | None:
    """Return window [h] and memory [days] of the arcs that resolved settings ask for, None for no arcs.

    Raises InputError where parts of a stack ask for different arcs, or for a column without a window.
    """
    parts = [part for part in settings.values() if isinstance(part, Mapping) and "kind" in part]
    arcs = {
        (float(part["window_hours"]), float(part.get("memory_days", ARC_MEMORY_DAYS)))
        for part in (settings, *parts)
        if "window_hours" in part
    }
    if len(arcs) > 1:
        raise InputError(f"learners: window_hours: expected one window for both parts, got {len(arcs)}")
    if {*tables_asked(settings["variables"])}.isdisjoint(ARC_TABLES):
        return None
    if not arcs:
        raise InputError("learners: expected window_hours beside columns of the arcs, got none")
    return arcs.pop()


def arc_windows(settings: Iterable[Settings]) -> list[float]:
    """Return the windows [h] of the arcs that resolved settings of learners ask for, each once."""
    return list(dict.fromkeys(arc[0] for arc in map(arc_of, settings) if arc))


def paths_of_each(paths: Iterable[Path], settings: Iterable[Settings]) -> list[list[Path]]:
    """Return the tables of each learner, of those of `tables_asked` that stand learner after learner.

    settings: of the learners, resolved
    """
    rest = iter(paths)
    return [[next(rest) for _ in tables_asked(learner["variables"])] for learner in settings]


def tables_asked(variables: Sequence[str]) -> list[str]:
    """Return the kinds of tables beside the dataset that have the variables, such as arcs and mechanism."""
    missing, kinds = set(variables) - {*LEARNING_VARIABLES, "gap"}, []
    for kind in _BESIDE:
        if missing & set(SCHEMAS[kind].names):
            kinds.append(kind)
        missing -= set(SCHEMAS[kind].names)
    return [*kinds, "mechanism"] if missing else kinds


def check_without_truth(name: str, settings: Settings) -> None:
    """Raise InputError where resolved settings ask for what only a simulation knows."""
    if "oracle" in tables_asked(settings["variables"]):
        raise InputError(f"learner '{name}': expected one that needs no truth to predict, got one that does")


def check(values: Mapping[str, Any]) -> None:
    """Raise InputError where a learner of the settings `values` asks for an unknown variable."""
    drifts = mechanism_schema(values["mechanism"]["resonances"]).names
    beside = [name for kind in _BESIDE for name in SCHEMAS[kind].names]
    known = {*LEARNING_VARIABLES, "gap", *drifts, *beside} - {"i", "j"}
    for name, settings in values["learners"].items():
        learner = resolved(settings, component=COMPONENTS[0], variables=values["learning"]["variables"])
        if unknown := sorted(set(learner["variables"]) - known):
            raise InputError(
                f"config: learners.{name}: expected learning variables and columns of the mechanism, "
                f"got {unknown[0]}"
            )


def _by_kind() -> dict[str, Learner]:
    return {learner.kind: learner for learner in (*LEARNERS, _STACKED)}


_STACKED = stacked.learner(by_kind)
