"""The settings of a run, held against their schema and against each other before anything is computed."""

import difflib
import math
import operator
import reprlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

import yaml
from jsonschema import Draft202012Validator, ValidationError

from opml.errors import InputError
from opml.sheets import Rso, Station, parse_rso, parse_stations, read_rsos, read_stations

Key = tuple[str | int, ...]


@dataclass(frozen=True)
class Settings:
    """What a run needs to know: the validated settings, the stations and the RSOs."""

    values: Mapping[str, Any]
    stations: Mapping[str, Station]
    rsos: Mapping[str, Rso]


def load(values: Mapping[str, Any], *, schema: str | Path, files: Sequence[str | Path] = ()) -> Settings:
    """Check merged settings and read the sheets that they name.

    Parameters
    ----------
    values : settings as merged from `files` and the command line.
    schema : path of the JSON schema (YAML) of the settings.
    files : YAML files that the settings came from, later ones overriding; used to name the file in messages.

    Raises
    ------
    InputError : one line with file and key, for the first thing that is wrong.
    """
    source = _Source(values, files)
    _check_keys(source)
    _check_schema(source, schema)
    _check_finite(source)
    _check_order(source)
    stations, rsos = read_stations(values["sheets"]["stations"]), read_rsos(values["sheets"]["rsos"])
    settings = Settings(values, stations, rsos)
    _check_names(source, settings)
    return settings


def with_numbers(values: Any) -> Any:
    """Return values with every text that spells a number as that number.

    Snakemake leaves what stands inside braces or brackets after ``--config`` as text.
    """
    if isinstance(values, Mapping):
        return {key: with_numbers(value) for key, value in values.items()}
    if isinstance(values, list):
        return [with_numbers(value) for value in values]
    if isinstance(values, str):
        for number in (int, float):
            with suppress(ValueError):
                return number(values)
    return values


def read_yaml(path: str | Path) -> Any:
    """Read a YAML file, safely. Raises InputError where it is missing or not YAML."""
    try:
        return yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path}: expected YAML ({error})") from None


@dataclass(frozen=True)
class _Source:
    """Settings and the files they were merged from."""

    values: Mapping[str, Any]
    files: Sequence[str | Path]

    def wrong(self, key: Key, what: str) -> InputError:
        """Return the error about a key, with the file that set it."""
        return InputError(f"{self._origin(key)}: {'.'.join(map(str, key))}: {what}")

    def _origin(self, key: Key) -> str:
        value = _at(self.values, key)
        if value is _MISSING:
            return str(self.files[0]) if self.files else "settings"
        for path in reversed(self.files):
            if repr(_at(read_yaml(path), key)) == repr(value):
                return str(path)
        return "--config"


_MISSING = object()


def _check_keys(source: _Source) -> None:
    """YAML allows keys that are no text, which a JSON schema does not foresee."""
    for key in _mappings(source.values):
        for name in _at(source.values, key):
            if not isinstance(name, str):
                raise source.wrong((*key, name), "expected a key that is text")


def _check_schema(source: _Source, schema: str | Path) -> None:
    for error in Draft202012Validator(read_yaml(schema)).iter_errors(source.values):
        raise source.wrong(*_explained(error))


def _check_finite(source: _Source) -> None:
    for key, value in _leaves(source.values):
        if isinstance(value, float) and not math.isfinite(value):
            raise source.wrong(key, f"expected a finite number, got {value}")


def _check_order(source: _Source) -> None:
    """Hold settings against each other that only make sense in one order."""
    for lower, upper in (
        (("integrator", "min_step_s"), ("integrator", "max_step_s")),
        (("cleaning", "cd_min"), ("cleaning", "cd_max")),
        (("force_models", "truth", "order"), ("force_models", "truth", "degree")),
        (("force_models", "assumed", "order"), ("force_models", "assumed", "degree")),
    ):
        low, high = _at(source.values, lower), _at(source.values, upper)
        if low > high:
            raise source.wrong(lower, f"expected at most {upper[-1]}, got {low} and {high}")
    for key in (("cleaning", "fence_days"), ("learning", "span_days")):
        first, last = _at(source.values, key)
        if first >= last:
            raise source.wrong(key, f"expected the first day before the last, got {first} and {last}")


def _check_names(source: _Source, settings: Settings) -> None:
    """Hold the names in the experiments against the sheets and the learners."""
    learners = settings.values["learners"]
    for name, experiment in settings.values["experiments"].items():
        key = ("experiments", name)
        for part, parse, sheet in (
            ("stations", parse_stations, settings.stations),
            ("rso", parse_rso, settings.rsos),
        ):
            try:
                parse(experiment[part], sheet)
            except InputError as error:
                raise source.wrong((*key, part), str(error)) from None
        if experiment["learner"] not in learners:
            known = ", ".join(learners)
            raise source.wrong((*key, "learner"), f"expected one of {known}, got {experiment['learner']!r}")


def _explained(error: ValidationError) -> tuple[Key, str]:
    """Return the key a schema error is about, and in one sentence what is wrong."""
    key, value, limit = tuple(error.absolute_path), error.instance, error.validator_value
    match error.validator:
        case "additionalProperties":
            known = list(error.schema["properties"])
            unknown = next(name for name in value if name not in known)
            close = difflib.get_close_matches(unknown, known, n=1)
            hint = f"did you mean {close[0]}?" if close else f"expected one of {', '.join(known)}"
            return (*key, unknown), f"unknown key; {hint}"
        case "required":
            missing = next(name for name in limit if name not in value)
            return (*key, missing), "expected a value, got none"
    if "description" in error.schema:
        expected = error.schema["description"]
    elif error.validator == "enum":
        expected = f"one of {', '.join(map(str, limit))}"
    else:
        expected = _EXPECTED.get(error.validator, "another value ({})").format(_TYPES.get(str(limit), limit))
    return key, f"expected {expected}, got {reprlib.repr(value)}"


_TYPES = {"object": "a mapping", "string": "text", "array": "a list", "number": "a number"}
_EXPECTED = {
    "type": "{}",
    "minimum": "at least {}",
    "maximum": "at most {}",
    "exclusiveMinimum": "more than {}",
    "exclusiveMaximum": "less than {}",
    "minItems": "a list of at least {}",
    "maxItems": "a list of at most {}",
    "uniqueItems": "no item twice",
    "pattern": "text of the form {}",
}


def _at(values: Any, key: Key) -> Any:
    """Return what stands under a key, _MISSING if nothing does."""
    try:
        return reduce(operator.getitem, key, values)
    except (KeyError, IndexError, TypeError):
        return _MISSING


def _leaves(values: Any, key: Key = ()) -> Iterator[tuple[Key, Any]]:
    items = values.items() if isinstance(values, Mapping) else enumerate(values)
    for part, value in items:
        if isinstance(value, Mapping | list):
            yield from _leaves(value, (*key, part))
        else:
            yield (*key, part), value


def _mappings(values: Mapping[str, Any], key: Key = ()) -> Iterator[Key]:
    yield key
    for part, value in values.items():
        if isinstance(value, Mapping):
            yield from _mappings(value, (*key, part))
