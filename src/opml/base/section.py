"""Base of every mapping of settings: keys with a meaning, a unit and limits, and no others."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import PydanticUndefined

from opml.base.errors import InputError
from opml.base.setting_types import Expected, Handler, TypeSchema


class Section(BaseModel):
    """A mapping of settings. A whole number may stand for a real one; nothing else is converted."""

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        # Rust's own engine has no lookahead.
        regex_engine="python-re",
        # The run's model is built as a whole.
        defer_build=True,
    )

    def evolve(self, **changes: Any) -> Self:
        """Return the same settings but for some."""
        return self.model_copy(update=changes)

    @classmethod
    def read(cls, values: Mapping[str, Any], name: str) -> Self:
        """Return the settings of a mapping. Raises InputError for the first that is wrong."""
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
        if first["type"] == "extra_forbidden":
            what = f"expected {', '.join(cls.model_fields)}, got {first['loc'][-1]}"
            raise InputError(f"{name}: settings: {what}")
        key = ".".join(map(str, first["loc"]))
        if first["type"] == "missing":
            raise InputError(f"{name}: {key}: expected a value, got none")
        what = first["msg"].replace("Input should be", "expected")
        # A type of several, such as a word or a number, is called by one name, and not by pydantic's of each.
        top = str(first["loc"][0])
        for mark in cls.model_fields[top].metadata if top in cls.model_fields else ():
            if isinstance(mark, Expected):
                key, what = top, f"expected {mark.words}"
        raise InputError(f"{name}: {key}: {what}, got {first['input']!r}")


class JobSettings(BaseModel):
    """Part of its rule's settings that a job takes; the digest of its tables knows the others."""

    model_config = ConfigDict(frozen=True, extra="ignore")


class Item(Section):
    """A mapping that is an item of a list, and so replaced as a whole by whatever is laid over it."""


def setting(
    meaning: str,
    *,
    unit: str = "",
    see: str = "",
    default: Any = PydanticUndefined,
    alias: str | None = None,
    shared: bool = False,
) -> Any:
    """Declare a setting.

    meaning: in one sentence
    unit: of its numbers, or the kind of its text
    see: the page of docs/ with more, or a heading of config/README.md
    default: its value where a file leaves it out; without one it has to stand in a file
    alias: its key, where Python has another meaning for that word
    shared: whether many mappings have it, so that it is documented once
    """
    extra: dict[str, Any] = {
        name: value for name, value in (("unit", unit), ("see", see), ("shared", shared)) if value
    }
    return Field(default, description=meaning, alias=alias, json_schema_extra=extra or None)


def absent(meaning: str, **more: Any) -> Any:
    """Declare a setting of a type `Absent`, which is None where a file leaves it out; more: as `setting`."""
    return setting(meaning, default=None, **more)


@dataclass(frozen=True)
class Placeholder:
    """Mark of names that a user gives: the word that stands for them in documentation, as in `<rso>`."""

    word: str

    def __get_pydantic_json_schema__(self, core: TypeSchema, handler: Handler) -> TypeSchema:
        return handler(core) | {"placeholder": self.word}
