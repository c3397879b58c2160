"""Settings checked against their models; the first thing that is wrong with them is stated in one line."""

import difflib
import reprlib
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from opml.base.setting_types import TypeSchema
from opml.study.settings.json_schema import child, choices, dereferenced, json_schema
from opml.study.settings.model.whole import RunSettings
from opml.study.settings.overlay import Key, Source, value_at, with_numbers

_NAME = "[key]"  # last part of the location of an error about a name, by pydantic


class _Refusal(NamedTuple):
    """A wrong value; the outermost sorts first."""

    mapping: Sequence[str]  # key of the mapping or value that a model does not take
    is_known: bool  # an unknown key is told before one that is missing, which it may stand for
    key: Key
    what: str


def validated(source: Source) -> RunSettings:
    """Return settings as a typed run. Raises InputError for the first value that is none of a run's."""
    try:
        return RunSettings.model_validate(source.values)
    except ValidationError as error:
        errors = error.errors(include_url=False)
    schema = json_schema(RunSettings)
    refusals = [_refusal(error, schema, source.values) for error in errors]
    first = min(refusals, key=lambda refusal: refusal[:2])
    raise source.wrong(first.key, first.what)


def _refusal(error: ErrorDetails, schema: TypeSchema, values: Any) -> _Refusal:
    """Return what an error of pydantic's says of a value, in the words of the schema."""
    location = error["loc"]
    if error["type"] == "extra_forbidden":
        mapping, node = _place(location[:-1], schema, values)
        return _Refusal(_text(mapping), False, location, f"unknown key; {_hint(location[-1], node)}")
    if location[-1] == _NAME:
        mapping, node = _place(location[:-2], schema, values)
        what = f"expected {_expected(error, node['propertyNames'])}, got {location[-2]!r}"
        return _Refusal(_text(mapping), True, location[:-1], what)
    if error["type"] == "missing" and isinstance(location[-1], str):
        return _Refusal(_text(location[:-1]), True, location, "expected a value, got none")
    # A pair that lacks an item is no pair.
    place, node = _place(location[:-1] if error["type"] == "missing" else location, schema, values)
    value = value_at(values, place)
    what = f"expected {_expected(error, node)}, got {reprlib.repr(value)}{_cause(error, value)}"
    return _Refusal(_text(place), True, place, what)


def _cause(error: ErrorDetails, value: Any) -> str:
    """Return why a number is none: quotes, or an exponent without a point, make it text."""
    is_number = (
        error["type"] == "float_type" and isinstance(value, str) and not isinstance(with_numbers(value), str)
    )
    return ", which YAML reads as text (quotes, or 1e1 in place of 1.0e+1)" if is_number else ""


def _place(location: Key, schema: TypeSchema, values: Any) -> tuple[Key, TypeSchema]:
    """Return the key that a location is in, without pydantic's words for kinds of values, and its node."""
    key: Key = ()
    node = dereferenced(schema, schema, values)
    for part in location:
        below = child(node, part)
        if below is None:
            break
        key = (*key, part)
        node = dereferenced(schema, below, value_at(values, key))
    return key, node


def _text(key: Key) -> Sequence[str]:
    return list(map(str, key))


def _hint(unknown: str | int, node: TypeSchema) -> str:
    known = list(node["properties"])
    for key, below in node["properties"].items():
        if unknown in choices(child(below, 0) or {}):
            return f"it is a name in the list {key}"
    close = difflib.get_close_matches(str(unknown), known, n=1)
    return f"did you mean {close[0]}?" if close else f"expected one of {', '.join(known)}"


def _expected(error: ErrorDetails, node: TypeSchema) -> str:
    context = error.get("ctx", {})
    match error["type"]:
        case "value_error":
            return str(context["error"])
        case "finite_number":
            return "a finite number"
    if "errorMessage" in node:
        return str(node["errorMessage"])
    if names := choices(node):
        return f"one of {', '.join(map(str, names))}"
    return _EXPECTED.get(error["type"], error["msg"]).format(**context)


_EXPECTED: Mapping[str, str] = {
    "bool_type": "true or false",
    "dict_type": "a mapping",
    "float_type": "a number",
    "invalid_key": "keys that are text",
    "list_type": "a list",
    "model_type": "a mapping",
    "string_too_short": "text of at least {min_length} letter",
    "string_type": "text",
    "too_short": "at least {min_length}",
}
