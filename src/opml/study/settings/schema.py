"""The settings' JSON schema, and what it says against values in one sentence."""

import difflib
import reprlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator, ValidationError

from opml import naming
from opml.base.yaml_files import read_yaml
from opml.environment.forecasts import methods
from opml.learning.models import learners
from opml.study.settings.overlay import Key, Source


def read_schema(path: str | Path) -> dict[str, Any]:
    """Read the schema; settings of learners and forecasts come from their kinds, splits from the names."""
    schema: dict[str, Any] = read_yaml(path)
    definitions = schema["$defs"]
    definitions["learner"] = learners.settings_schema()
    definitions["forecast"] = methods.settings_schema()
    definitions["train"]["pattern"] = f"^(?:{naming.TRAIN})$"
    definitions["test"]["pattern"] = f"^(?:{naming.TEST})$"
    return schema


def check_schema(source: Source, schema: Mapping[str, Any]) -> None:
    """Raise InputError for the first value that the schema does not allow."""
    errors = Draft202012Validator(schema).iter_errors(source.values)
    # jsonschema's own order changes from run to run.
    first = min(errors, key=lambda error: list(map(str, error.absolute_path)), default=None)
    if first is not None:
        raise source.wrong(*_explained(first))


def _explained(error: ValidationError) -> tuple[Key, str]:
    """Return the key a schema error is about, and in one sentence what is wrong."""
    key, value, limit = tuple(error.absolute_path), error.instance, error.validator_value
    match error.validator:
        case "additionalProperties":
            unknown, hint = _unknown_key(value, list(error.schema["properties"]))
            return (*key, unknown), f"unknown key; {hint}"
        case "required":
            missing = next(name for name in limit if name not in value)
            return (*key, missing), "expected a value, got none"
    if "propertyNames" in error.absolute_schema_path:
        key = (*key, value)  # what is wrong is a name, which the path of an error leaves out
    return key, f"expected {_expected(error)}, got {reprlib.repr(value)}"


def _unknown_key(value: Mapping[str, Any], known: list[str]) -> tuple[str, str]:
    """Return the first key that is not known, and what may have been meant."""
    unknown = next(name for name in value if name not in known)
    close = difflib.get_close_matches(unknown, known, n=1)
    return unknown, f"did you mean {close[0]}?" if close else f"expected one of {', '.join(known)}"


def _expected(error: ValidationError) -> str:
    limit = error.validator_value
    if "description" in error.schema and error.validator != "uniqueItems":
        return str(error.schema["description"])
    if error.validator == "enum":
        return f"one of {', '.join(map(str, limit))}"
    return _EXPECTED.get(str(error.validator), "another value ({})").format(_TYPES.get(str(limit), limit))


_TYPES = {
    "object": "a mapping",
    "['object', 'null']": "a mapping",
    "string": "text",
    "array": "a list",
    "number": "a number",
}
_EXPECTED = {
    "type": "{}",
    "minimum": "at least {}",
    "maximum": "at most {}",
    "exclusiveMinimum": "more than {}",
    "exclusiveMaximum": "less than {}",
    "minItems": "a list of at least {}",
    "maxItems": "a list of at most {}",
    "minLength": "text of at least {} letter",
    "uniqueItems": "no item twice",
    "pattern": "text of the form {}",
}
