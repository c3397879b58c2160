"""The learners by `kind`: the one place to add another to.

A learner is a module-level `fit(x, y, *, variables, settings, seed, groups)` that returns a frozen model with
`variables`, `predict(x)`, `to_table()` and the class method `from_table(table, metadata)`.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from os import PathLike

import numpy as np
import pandas as pd

from opml.errors import InputError
from opml.learning import baselines, boosting, gaussian_process, mechanism, mlp, ridge, stacked, svr
from opml.learning.evaluation import Model
from opml.tables import (
    COMPONENTS,
    LEARNING_VARIABLES,
    MECHANISM_AXES,
    SCHEMAS,
    Schema,
    mechanism_schema,
    model_schema,
    read_metadata,
    read_table,
)


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


def train(rows: pd.DataFrame, *, component: str, settings: Mapping, seed: int) -> Model:
    """Train a learner on rows of a dataset; `settings` as `resolved` gives them. Errors as `fit`."""
    variables = settings["variables"]
    return fit(
        rows[variables].to_numpy(),
        rows[component].to_numpy(),
        variables=variables,
        settings=settings,
        seed=seed,
        groups=rows["i"].to_numpy(),
    )


def read(path: str | PathLike) -> Model:
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
def _naming(path: str | PathLike) -> Iterator[None]:
    """Turn whatever is amiss with a model's description or numbers into one line with the file's name."""
    try:
        yield
    except (InputError, LookupError, TypeError, ValueError) as reason:
        raise InputError(f"{path}: expected a model whose parts fit each other, got {reason!r}") from None


def from_table(table: pd.DataFrame, metadata: Mapping) -> Model:
    """The model of a saved table, whatever its kind; raises InputError for an unknown kind."""
    return _by_kind(LOADS, metadata["kind"])(table, metadata)


def schema(metadata: Mapping) -> Schema:
    """The schema of a model's table, from the metadata beside it; raises InputError for an unknown kind."""
    if metadata["kind"] == "stacked":
        return schema(metadata["second"])
    _by_kind(FITS, metadata["kind"])
    return model_schema(metadata["variables"], metadata["kind"])


def resolved(settings: Mapping, *, component: str, variables: Sequence[str]) -> dict:
    """A learner's settings for one error component, with the `variables` it learns from spelled out.

    `variables` are those of a learner whose settings name none; its `without` are left out. A sensitivity
    (`v`) stands for its component's own (`v_y`), in variables and terms alike.
    """
    kind, axis = settings["kind"], component.removeprefix("e_")
    found = {key: value for key, value in settings.items() if key != "without"}
    if kind == "stacked":
        for part in ("first", "second"):
            found[part] = resolved(settings[part], component=component, variables=variables)
        names = found["first"]["variables"] + found["second"]["variables"]
    elif kind == "mechanism":
        found["terms"] = ["*".join(_named(term.split("*"), axis)) for term in settings["terms"]]
        names = mechanism.factors(found["terms"])
    else:
        chosen = FIXED.get(kind, settings.get("variables", variables))
        names = _named([name for name in chosen if name not in settings.get("without", [])], axis)
    return found | {"variables": list(dict.fromkeys(names))}


def check(values: Mapping) -> None:
    """Raise InputError where a learner of the settings' `values` asks for a variable that there is not."""
    drifts = mechanism_schema(values["mechanism"]["resonances"]).names
    known = {*LEARNING_VARIABLES, "gap", *drifts, *SCHEMAS["oracle"].names} - {"i", "j"}
    for name, settings in values["learners"].items():
        own = resolved(settings, component=COMPONENTS[0], variables=values["learning"]["variables"])
        if unknown := sorted(set(own["variables"]) - known):
            raise InputError(
                f"config: learners.{name}: expected learning variables and columns of the mechanism, "
                f"got {unknown[0]}"
            )


def _named(names: Sequence[str], axis: str) -> list[str]:
    return [f"{name}_{axis}" if name in MECHANISM_AXES else name for name in names]


def _by_kind(table: Mapping, kind: str) -> object:
    if kind not in table:
        raise InputError(f"learners: kind: expected {', '.join(table)}, got {kind}")
    return table[kind]


FIXED = {"none": [], "duration_mean": ["duration"], "repredict": ["r"]}
"""The variables of the kinds that leave no choice."""

FITS = {
    "svr": svr.fit,
    "none": baselines.fit_none,
    "duration_mean": baselines.fit_duration_mean,
    "repredict": baselines.fit_repredict,
    "ridge": ridge.fit,
    "mechanism": mechanism.fit,
    "boosting": boosting.fit,
    "gaussian_process": gaussian_process.fit,
    "mlp": mlp.fit,
    "stacked": partial(stacked.fit, train=fit),
}

LOADS = {
    "svr": svr.SvrModel.from_table,
    "none": baselines.NoCorrection.from_table,
    "duration_mean": baselines.DurationMean.from_table,
    "repredict": baselines.Repredicted.from_table,
    "ridge": ridge.RidgeModel.from_table,
    "mechanism": mechanism.MechanismModel.from_table,
    "boosting": boosting.BoostingModel.from_table,
    "gaussian_process": gaussian_process.GaussianProcessModel.from_table,
    "mlp": mlp.MlpModel.from_table,
    "stacked": partial(stacked.from_table, load=from_table),
}
