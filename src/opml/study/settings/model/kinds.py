"""Settings whose keys depend on their `kind`: a learner's and a forecast's, as each kind declares them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

from pydantic import ConfigDict, create_model

from opml.base.section import Section
from opml.base.setting_types import Handler, OneOf, TypeSchema, may_be_absent
from opml.environment.forecasts import methods
from opml.learning.models import contract, learners

KINDS = "x-kinds"
"""Key under which the JSON schema of settings of any kind has the name of their definition."""


class OfSomeKind(Section):
    """Settings that name their kind."""

    kind: str


class _OthersIgnored(OfSomeKind):
    """Settings of which the kind alone is looked at."""

    model_config = ConfigDict(extra="ignore")


@dataclass(frozen=True)
class OfItsKind:
    """Mark of a mapping whose keys are those of its kind.

    name: of the definition in the JSON schema
    kinds: the types of each kind's own keys, for the kinds that there are when settings are checked
    """

    name: str
    kinds: Callable[[], Mapping[str, Mapping[str, Any]]]

    def __get_pydantic_core_schema__(self, source: Any, handler: Handler) -> TypeSchema:
        return {"type": "function-plain", "function": {"type": "no-info", "function": self.validated}}

    def __get_pydantic_json_schema__(self, core: TypeSchema, handler: Handler) -> TypeSchema:
        return {KINDS: self.name}

    def validated(self, values: Any) -> OfSomeKind:
        """Return settings as the model of their kind. Raises pydantic's ValidationError."""
        kinds = self.kinds()
        kind = _kind_alone(tuple(kinds)).model_validate(values).kind
        return _model(kind, tuple(kinds[kind].items())).model_validate(values)

    def models(self) -> dict[str, type[OfSomeKind]]:
        """Return the model of each kind's settings."""
        return {kind: _model(kind, tuple(keys.items())) for kind, keys in self.kinds().items()}


@lru_cache
def _kind_alone(kinds: tuple[str, ...]) -> type[OfSomeKind]:
    fields: dict[str, Any] = {"kind": (Annotated[str, OneOf(kinds)], ...)}
    return create_model("KindAlone", __base__=_OthersIgnored, **fields)


@lru_cache
def _model(kind: str, keys: tuple[tuple[str, Any], ...]) -> type[OfSomeKind]:
    types = {key: LearnerSettings if declared is contract.AnyLearner else declared for key, declared in keys}
    fields: dict[str, Any] = {
        key: (declared, None if may_be_absent(declared) else ...) for key, declared in types.items()
    }
    return create_model(kind, __base__=OfSomeKind, **fields)


LEARNER_KINDS = OfItsKind("learner", learners.settings_types)
FORECASTS = OfItsKind("forecast", methods.settings_types)

LearnerSettings = Annotated[OfSomeKind, LEARNER_KINDS]
"""Settings of a learner; those of its kind stand beside `kind`."""

ForecastSettings = Annotated[OfSomeKind, FORECASTS]
"""Settings of a forecast of the weather."""
