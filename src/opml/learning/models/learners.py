"""The learners by `kind`, and all that is done with one whatever its kind.

A kind is declared by a `Learner` in its own module and named in `LEARNERS`; docs/howto.md shows how.
``python -m opml.learning.models.learners`` prints docs/data.md.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.learning.models import (
    baselines,
    boosting,
    fixed_laws,
    gaussian_process,
    linear_law,
    mlp,
    ridge,
    stacked,
    svr,
)
from opml.learning.models.contract import ARC_MEMORY_DAYS, Learner, Metadata, Model, Settings
from opml.learning.models.inputs import columns_of, inverse_variances
from opml.tables import (
    COMPONENTS,
    LEARNING_VARIABLES,
    SCHEMAS,
    Schema,
    markdown,
    mechanism_schema,
    read_metadata,
    read_table,
)

LEARNERS: tuple[Learner, ...] = (
    svr.LEARNER,
    baselines.NONE,
    baselines.DURATION_MEAN,
    baselines.REPREDICT,
    ridge.LEARNER,
    linear_law.LEARNER,
    boosting.LEARNER,
    gaussian_process.LEARNER,
    mlp.LEARNER,
    fixed_laws.REFITTED,
    fixed_laws.HELD,
    fixed_laws.RUNNING,
    fixed_laws.THERMOMETER,
)
"""The kinds that stand alone, one line each. Any two of them make a stack."""


def by_kind(kind: str) -> Learner:
    """The learner of a kind; raises InputError for an unknown one."""
    known = _by_kind()
    if kind not in known:
        raise InputError(f"learners: kind: expected {', '.join(known)}, got {kind}")
    return known[kind]


def description(kind: str) -> str:
    """What a kind of learner is, in words; raises InputError for an unknown kind."""
    return by_kind(kind).description


def learns(settings: Settings) -> bool:
    """Whether the learner of settings takes anything from errors; raises InputError for an unknown kind."""
    return by_kind(settings["kind"]).learns


def settings_types() -> dict[str, Mapping[str, Any]]:
    """Return the type of each key that the settings of a kind have beside `kind`, by kind."""
    return {kind: learner.settings for kind, learner in _by_kind().items()}


def fit(
    x: np.ndarray,
    y: np.ndarray,
    *,
    variables: Sequence[str],
    settings: Settings,
    seed: int,
    groups: np.ndarray | None = None,
    weights: np.ndarray | None = None,
) -> Model:
    """Train the learner that `settings['kind']` names; raises InputError for an unknown kind."""
    learner = by_kind(settings["kind"])
    return learner.fit(
        x, y, variables=variables, settings=settings, seed=seed, groups=groups, weights=weights
    )


def train(rows: pd.DataFrame, *, component: str, settings: Settings, seed: int) -> Model:
    """Train a learner on rows of a dataset; `settings` as `resolved` gives them. Errors as `fit`.

    Labels from later estimates are weighted by their own uncertainty.
    """
    variables = settings["variables"]
    sigma = rows.get(f"sigma_{component}")
    return fit(
        columns_of(rows, variables),
        rows[component].to_numpy(),
        variables=variables,
        settings=settings,
        seed=seed,
        groups=rows["i"].to_numpy(),
        weights=None if sigma is None else inverse_variances(sigma.to_numpy()),
    )


def read(path: str | PathLike[str]) -> Model:
    """The model of a file. Raises InputError where it is missing, damaged or no model that holds together."""
    described = read_metadata(path)
    with _naming(path):
        columns = schema(described)
    table = read_table(path, columns)
    with _naming(path):
        model = from_table(table, described)
        # Someone else may have made it: one row tells whether its parts fit each other.
        with np.errstate(all="ignore"):
            tried = model.predict(np.zeros((1, len(model.variables))))
        if tried.shape != (1,) or not np.isfinite(tried).all():
            raise ValueError(f"predicts {tried}")
    return model


@contextmanager
def _naming(path: str | PathLike[str]) -> Iterator[None]:
    """Turn whatever is amiss with a model's description or numbers into one line with the file's name."""
    try:
        yield
    except (InputError, LookupError, TypeError, ValueError) as reason:
        raise InputError(f"{path}: expected a model whose parts fit each other, got {reason!r}") from None


def from_table(table: pd.DataFrame, metadata: Metadata) -> Model:
    """The model of a saved table, whatever its kind; raises InputError for an unknown kind."""
    return by_kind(metadata["kind"]).load(table, metadata)


def schema(metadata: Metadata) -> Schema:
    """The schema of a model's table, from the metadata beside it; raises InputError for an unknown kind."""
    return by_kind(metadata["kind"]).table(metadata)


def schemas() -> list[Schema]:
    """The tables of models of all learning variables; a stack is kept in the table of its second part."""
    return [one.table({"kind": one.kind, "variables": LEARNING_VARIABLES}) for one in LEARNERS]


def resolved(settings: Settings, *, component: str, variables: Sequence[str]) -> dict[str, Any]:
    """A learner's settings for one error component, with the `variables` it learns from spelled out.

    `variables` are those of a learner whose settings name none; its `without` are left out. A sensitivity
    (`v`) stands for its component's own (`v_y`), in variables and terms alike. Raises InputError for an
    unknown kind.
    """
    return by_kind(settings["kind"]).resolve(settings, component=component, variables=variables)


def arc_of(settings: Settings) -> tuple[float, float] | None:
    """Window [h] and memory [days] of the arcs that resolved settings ask for; None where they ask for none.

    Raises InputError where parts of a stack ask for different ones, or for a column without a window.
    """
    parts = [part for part in settings.values() if isinstance(part, Mapping) and "kind" in part]
    arcs = {
        (float(one["window_hours"]), float(one.get("memory_days", ARC_MEMORY_DAYS)))
        for one in (settings, *parts)
        if "window_hours" in one
    }
    if len(arcs) > 1:
        raise InputError(f"learners: window_hours: expected one window for both parts, got {len(arcs)}")
    if not arcs and set(settings["variables"]) & set(SCHEMAS["arcs"].names):
        raise InputError("learners: expected window_hours beside columns of the arcs, got none")
    return next(iter(arcs), None)


def tables_asked(variables: Sequence[str]) -> list[str]:
    """The kinds of tables beside the dataset that have the `variables`, such as arcs and mechanism."""
    asked, kinds = set(variables) - {*LEARNING_VARIABLES, "gap"}, []
    for kind in ("oracle", "arcs", "thermometer"):
        if asked & set(SCHEMAS[kind].names):
            kinds.append(kind)
        asked -= set(SCHEMAS[kind].names)
    return [*kinds, "mechanism"] if asked else kinds


def check_without_truth(name: str, settings: Settings) -> None:
    """Raise InputError where the resolved settings of a learner ask for what only a simulation knows."""
    if "oracle" in tables_asked(settings["variables"]):
        raise InputError(f"learner '{name}': expected one that needs no truth to predict, got one that does")


def check(values: Mapping[str, Any]) -> None:
    """Raise InputError where a learner of the settings' `values` asks for a variable that there is not."""
    drifts = mechanism_schema(values["mechanism"]["resonances"]).names
    beside = [name for kind in ("oracle", "arcs", "thermometer") for name in SCHEMAS[kind].names]
    known = {*LEARNING_VARIABLES, "gap", *drifts, *beside} - {"i", "j"}
    for name, settings in values["learners"].items():
        own = resolved(settings, component=COMPONENTS[0], variables=values["learning"]["variables"])
        if unknown := sorted(set(own["variables"]) - known):
            raise InputError(
                f"config: learners.{name}: expected learning variables and columns of the mechanism, "
                f"got {unknown[0]}"
            )
        if settings["kind"] == "thermometer" and "thermometer" not in values:
            raise InputError(f"config: learners.{name}: expected a setting thermometer beside it, got none")


def _by_kind() -> dict[str, Learner]:
    return {learner.kind: learner for learner in (*LEARNERS, _STACKED)}


_STACKED = stacked.learner(by_kind)


if __name__ == "__main__":
    print(markdown(schemas()))
