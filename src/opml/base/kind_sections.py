"""Settings whose keys depend on their `kind`: a learner's, as each kind declares them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

from pydantic import create_model

from opml.base.section import JobSettings, Section
from opml.base.setting_types import Handler, OneOf, TypeSchema

KINDS = "x-kinds"  # key under which the JSON schema of settings of any kind has the name of their definition


@dataclass(frozen=True)
class OfItsKind:
    """Mark of a mapping whose keys are those of its kind."""

    name: str  # of the definition in the JSON schema
    sections: Callable[[], Mapping[str, type[Section]]]  # by kind, when settings are checked

    def __get_pydantic_core_schema__(self, source: Any, handler: Handler) -> TypeSchema:
        return {"type": "function-plain", "function": {"type": "no-info", "function": self.validated}}

    def __get_pydantic_json_schema__(self, core: TypeSchema, handler: Handler) -> TypeSchema:
        return {KINDS: self.name}

    def validated(self, values: Any) -> Section:
        """Return settings as the section of their kind. Raises pydantic's ValidationError."""
        if isinstance(values, Section):
            return values
        sections = self.sections()
        kind = _kind_alone(tuple(sections)).model_validate(values).model_dump()["kind"]
        return sections[kind].model_validate(values)


@lru_cache
def _kind_alone(kinds: tuple[str, ...]) -> type[JobSettings]:
    """Return the model of settings of which the kind alone is looked at."""
    fields: dict[str, Any] = {"kind": (Annotated[str, OneOf(kinds)], ...)}
    return create_model("KindAlone", __base__=JobSettings, **fields)
