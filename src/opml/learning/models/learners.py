"""The learners by `kind`, and what can be done with any of them.

A kind is declared by a `Learner` in its own module and named in `LEARNERS`; docs/howto.md shows how.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from typing import Annotated, Any

import numpy as np
import pandas as pd
from pydantic import AfterValidator, GetJsonSchemaHandler, PlainSerializer, PlainValidator

from opml.base.errors import InputError
from opml.base.section import JobSettings
from opml.base.setting_types import TypeSchema
from opml.learning.models import boosting, fixed_laws, linear_law, svr
from opml.learning.models.contract import (
    ARC_MEMORY_DAYS,
    Learner,
    LearnerSettings,
    Metadata,
    Model,
    ResolvedSettings,
)
from opml.learning.models.training_inputs import Training
from opml.tables import (
    COMPONENTS,
    LEARNING_VARIABLES,
    SCHEMAS,
    Schema,
    mechanism_schema,
    read_metadata,
    read_table,
)

LEARNERS: tuple[Learner[Any], ...] = (
    svr.LEARNER,
    fixed_laws.NONE,
    linear_law.LEARNER,
    boosting.LEARNER,
    fixed_laws.REFITTED,
    fixed_laws.RUNNING,
)
"""The kinds."""

ARC_TABLES = ("arcs", "cd_past")
"""Kinds of further tables that are made for the window, and the memory, of a learner's arcs.

All further columns are the mechanism's.
"""


def by_kind(kind: str) -> Learner[Any]:
    """Return the learner of a kind; raise InputError for an unknown one."""
    known = _by_kind()
    if kind not in known:
        raise InputError(f"learners: kind: expected {', '.join(known)}, got {kind}")
    return known[kind]


def description(kind: str) -> str:
    """Return what a kind of learner is, in words; raise InputError for an unknown kind."""
    return by_kind(kind).description


def learns(settings: LearnerSettings) -> bool:
    """Return whether the learner takes anything from errors."""
    return by_kind(settings.kind).learns


def settings_of(values: Mapping[str, Any]) -> LearnerSettings:
    """Return the settings of a learner; raise InputError for what no kind takes."""
    section: type[LearnerSettings] = by_kind(str(values.get("kind"))).settings
    return section.read(values, "learner")


def fit(training: Training, settings: ResolvedSettings) -> Model:
    """Train the learner that the settings are of; raise InputError for rows that it cannot learn from."""
    return by_kind(settings.own.kind).fit(training, settings.own)


def train(rows: pd.DataFrame, *, component: str, settings: ResolvedSettings, seed: int) -> Model:
    """Train a learner on rows of a dataset for one error component.

    settings: as `LearnerSettings.resolved` returns them

    Raises InputError as `Training.from_rows` and `fit` do.
    """
    return fit(Training.from_rows(rows, settings.variables, component=component, seed=seed), settings)


def read(path: str | PathLike[str]) -> Model:
    """Read a model; raise InputError for a file that is missing or damaged, or whose parts do not fit."""
    described = read_metadata(path)
    with _naming(path):
        columns = schema(described)
    table = read_table(path, columns)
    with _naming(path):
        model = by_kind(described["kind"]).load(table, described)
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


def schema(metadata: Metadata) -> Schema:
    """Return the schema of a model's table from its metadata; raise InputError for an unknown kind."""
    return by_kind(metadata["kind"]).table(metadata)


def schemas() -> list[Schema]:
    """Return the tables of models of all learning variables."""
    return [learner.table({"kind": learner.kind, "variables": LEARNING_VARIABLES}) for learner in LEARNERS]


def of_job(values: Mapping[str, Any] | ResolvedSettings) -> ResolvedSettings:
    """Return resolved settings, where they stand as the JSON values that `ResolvedSettings.of_job` made."""
    if isinstance(values, ResolvedSettings):
        return values
    own = dict(values)
    variables = list(own.pop("variables"))
    return ResolvedSettings(by_kind(own.get("kind", "")).settings.model_validate(own), variables)


JobLearner = Annotated[ResolvedSettings, PlainValidator(of_job), PlainSerializer(ResolvedSettings.of_job)]
"""Type of a job's setting that is a learner for one error component."""


def arc_of(settings: ResolvedSettings) -> tuple[float, float] | None:
    """Return window [h] and memory [days] of the arcs that resolved settings ask for, None for no arcs.

    Raises InputError for a column of the arcs without a window.
    """
    if {*needed_tables(settings.variables)}.isdisjoint(ARC_TABLES):
        return None
    hours = settings.own.get("window_hours")
    if not hours:
        raise InputError("learners: expected window_hours with columns of the arcs, got none")
    return float(hours), float(settings.own.get("memory_days") or ARC_MEMORY_DAYS)


def arc_windows(settings: Iterable[ResolvedSettings]) -> list[float]:
    """Return the windows [h] of the arcs that resolved settings of learners ask for, each once."""
    return list(dict.fromkeys(arc[0] for arc in map(arc_of, settings) if arc))


def needed_tables(variables: Sequence[str]) -> list[str]:
    """Return the kinds of further tables that have the variables, such as arcs and mechanism."""
    missing, kinds = set(variables) - {*LEARNING_VARIABLES, "gap"}, []
    for kind in ARC_TABLES:
        if missing & set(SCHEMAS[kind].names):
            kinds.append(kind)
        missing -= set(SCHEMAS[kind].names)
    return [*kinds, "mechanism"] if missing else kinds


def check(
    settings: Mapping[str, LearnerSettings],
    *,
    variables: Sequence[str],
    resonances: Sequence[tuple[int, int]],
) -> None:
    """Raise InputError where a learner of these settings asks for an unknown variable.

    settings: by the learners' names
    variables: those of the settings to learn from by default
    resonances: pairs (k, m) that may be learned from
    """
    drifts = mechanism_schema(resonances).names
    further = [name for kind in ARC_TABLES for name in SCHEMAS[kind].names]
    known = {*LEARNING_VARIABLES, "gap", *drifts, *further} - {"i", "j"}
    for name, own in settings.items():
        learner = own.resolved(component=COMPONENTS[0], variables=variables)
        if unknown := sorted(set(learner.variables) - known):
            raise InputError(
                f"config: learners.{name}: expected learning variables and columns of the mechanism, "
                f"got {unknown[0]}"
            )


def _by_kind() -> dict[str, Learner[Any]]:
    return {learner.kind: learner for learner in LEARNERS}


def _known(kind: str) -> str:
    if kind not in _by_kind():
        raise ValueError(f"one of {', '.join(_by_kind())}")
    return kind


class _OfItsKind(JobSettings):
    """A learner of which the kind alone is looked at; its schema has the keys of each kind."""

    kind: Annotated[str, AfterValidator(_known)]

    @classmethod
    def __get_pydantic_json_schema__(cls, core: Any, handler: GetJsonSchemaHandler) -> TypeSchema:
        kinds = []
        for kind, learner in _by_kind().items():
            learner.settings.model_rebuild()
            section = handler.resolve_ref_schema(handler(learner.settings.__pydantic_core_schema__))
            is_it = {"properties": {"kind": {"const": kind}}, "required": ["kind"]}
            kinds.append({"if": is_it, "then": {k: v for k, v in section.items() if k != "description"}})
        return {"type": "object", "properties": {"kind": {"enum": list(_by_kind())}}, "allOf": kinds}


def _validated(values: Any) -> LearnerSettings:
    if isinstance(values, LearnerSettings):
        return values
    section: type[LearnerSettings] = by_kind(_OfItsKind.model_validate(values).kind).settings
    return section.model_validate(values)


AnyLearner = Annotated[LearnerSettings, PlainValidator(_validated, json_schema_input_type=_OfItsKind)]
"""Settings of a learner, of whatever kind."""
