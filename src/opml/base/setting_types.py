"""Types of settings: what may stand under a key, and how a refusal calls it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from annotated_types import Ge, Gt, Lt, MinLen
from pydantic import Strict

TypeSchema = dict[str, Any]  # a core schema or a JSON schema of pydantic's
Handler = Callable[[Any], TypeSchema]  # what makes the schema of the type that a mark stands on


@dataclass(frozen=True)
class Expected:
    """Mark of a type: the words that follow `expected` in a refusal, and in an editor."""

    words: str

    def __get_pydantic_json_schema__(self, core: TypeSchema, handler: Handler) -> TypeSchema:
        return handler(core) | {"errorMessage": self.words}


@dataclass(frozen=True)
class OneOf:
    """Mark of a text that is one of some names."""

    names: Iterable[str]  # which are read when a setting of the type is first checked

    def __get_pydantic_core_schema__(self, source: Any, handler: Handler) -> TypeSchema:
        return {"type": "literal", "expected": list(self.names)}


@dataclass(frozen=True)
class Unique:
    """Mark of a list that has no item twice."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Handler) -> TypeSchema:
        check = {"type": "no-info", "function": _without_repetition}
        return {"type": "function-after", "function": check, "schema": handler(source)}

    def __get_pydantic_json_schema__(self, core: TypeSchema, handler: Handler) -> TypeSchema:
        return handler(core) | {"uniqueItems": True}


class _Given:
    """Mark of a type that stands for None where its key is left out, and takes no None from a file."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Handler) -> TypeSchema:
        return handler(source)["schema"]


T = TypeVar("T")

Absent = Annotated[T | None, _Given()]  # type of a setting that may be left out; it is None then


def _without_repetition(items: list[Any]) -> list[Any]:
    if len(set(items)) < len(items):
        raise ValueError("no item twice")
    return items


Positive = Annotated[float, Gt(0), Expected("a number above 0")]

NotNegative = Annotated[float, Ge(0), Expected("a number from 0")]

Share = Annotated[float, Gt(0), Lt(1), Expected("a number between 0 and 1")]

Count = Annotated[int, Ge(1), Expected("a whole number above 0")]

Text = Annotated[str, MinLen(1)]

Day = Annotated[float, Ge(0), Expected("a day, a number from 0")]

# YAML has lists only: they stand for tuples, whose items stay as strict as all else.
Days = Annotated[tuple[Day, Day], Strict(False), Expected("two numbers, first and last day")]
