"""The settings of a run, held against their schema and against each other before anything is computed."""

import difflib
import math
import operator
import reprlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

import yaml
from jsonschema import Draft202012Validator, ValidationError

from opml import experiments, naming
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
    _check_messages(source, settings)
    _check_pools(source, settings)
    _check_experiments(source, settings)
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
    errors = Draft202012Validator(read_yaml(schema)).iter_errors(source.values)
    # jsonschema's own order changes from run to run.
    first = min(errors, key=lambda error: list(map(str, error.absolute_path)), default=None)
    if first is not None:
        raise source.wrong(*_explained(first))


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


def _check_messages(source: _Source, settings: Settings) -> None:
    """Hold the names of RSOs whose truth is an ephemeris message against the sheet."""
    for name in source.values.get("oem", {}):
        try:
            parse_rso(name, settings.rsos)
        except InputError as error:
            raise source.wrong(("oem", name), str(error)) from None


def _check_pools(source: _Source, settings: Settings) -> None:
    """Hold the RSOs of the pools against the sheet."""
    for name, rsos in source.values["pools"].items():
        try:
            for rso in rsos:
                parse_rso(rso, settings.rsos)
        except InputError as error:
            raise source.wrong(("pools", name), str(error)) from None


def _check_experiments(source: _Source, settings: Settings) -> None:
    """Hold the experiments against the sheets, the learners, the days of the run and each other."""
    values = settings.values
    entries = values["experiments"]
    _check_parts(source, settings, (), entries["defaults"])
    for key, entry in _entries(entries):
        _check_parts(source, settings, key, entry)
    for name, experiment in experiments.evaluations(values).items():
        if experiment.test == "seen" and experiment.target != experiment.rso:
            key = ("experiments", "evaluations", name, "test")
            raise source.wrong(key, "expected another split, as seen rows are the RSO's own")
    for key, known in (
        (("individual", "evaluation"), entries["evaluations"]),
        (("components",), entries["evaluations"]),
        (("partition", "shown"), entries["partition"]["ratios"]),
        (("generalisation", "intervals", "learners"), entries["generalisation"]["learners"]),
        (("generalisation", "intervals", "splits"), entries["generalisation"]["splits"]),
        (("reproduction", "calibrated"), entries["evaluations"]),
        (("reproduction", "fixed"), values["learners"]),
    ):
        named = _at(entries, key)
        for name in named if isinstance(named, list) else [named]:
            if name not in known:
                expected = f"one of {', '.join(map(str, known))}"
                raise source.wrong(("experiments", *key), f"expected {expected}, got {name!r}")
    fixed = entries["reproduction"]["fixed"]
    if not isinstance(values["learners"][fixed].get("kernel_scale"), int | float):
        key = ("learners", fixed, "kernel_scale")
        raise source.wrong(key, "expected a number, as it stands for one fixed scale")


def _entries(entries: Mapping[str, Any]) -> Iterator[tuple[Key, Mapping[str, Any]]]:
    """Yield every entry that names stations, RSOs, learners or splits, with its key."""
    for kind in ("orbit", "distribution", "partition", "kernel_scale", "generalisation"):
        yield (kind,), entries[kind]
    yield ("generalisation", "transfers"), entries["generalisation"]["transfers"]
    yield ("generalisation", "budget"), entries["generalisation"]["budget"]
    for kind in ("evaluations", "grids", "curves"):
        for name, entry in entries[kind].items():
            yield (kind, name), entry
    for name, entry in entries["reproduction"]["readings"].items():
        yield ("reproduction", "readings", name), entry


def _check_parts(source: _Source, settings: Settings, key: Key, entry: Mapping[str, Any]) -> None:
    """Hold what an entry of the experiments names against what there is."""
    where = ("experiments", *(key or ("defaults",)))
    learners = settings.values["learners"]
    rso = entry.get("rso", settings.values["experiments"]["defaults"]["rso"])
    checks: dict[str, Callable[[Any], object]] = {
        "rso": lambda text: parse_rso(text, settings.rsos),
        "rsos": lambda texts: [parse_rso(text, settings.rsos) for text in texts],
        "target": lambda text: parse_rso(text, settings.rsos),
        "inclinations": lambda degrees: [naming.with_inclination(rso, one, settings.rsos) for one in degrees],
        "offsets": lambda kms: [
            parse_rso(naming.with_offset(rso, km, settings.rsos), settings.rsos) for km in kms
        ],
        "stations": lambda text: parse_stations(text, settings.stations),
        "station_sets": lambda texts: [parse_stations(text, settings.stations) for text in texts],
        "learner": lambda text: naming.parse_learner(text, learners),
        "learners": lambda texts: [naming.parse_learner(text, learners) for text in texts],
        "rules": lambda texts: [naming.parse_learner(text, learners) for text in texts],
        "train": lambda text: _check_split(text, settings),
        "test": lambda text: _check_split(text, settings),
        "tests": lambda texts: [_check_split(text, settings) for text in texts],
        "splits": lambda pairs: [_check_split(text, settings) for pair in _values(pairs) for text in pair],
        "split": lambda pair: [_check_split(text, settings) for text in _values(pair)],
        "window_day": lambda day: _check_days([0, day], settings),
        "zoom_days": lambda days: _check_days(days, settings),
    }
    for part, value in entry.items():
        try:
            checks.get(part, bool)(value)
        except InputError as error:
            raise source.wrong((*where, part), str(error)) from None


def _values(entries: Mapping[str, Any] | Sequence[Any]) -> Sequence[Any]:
    """Return what is listed, under names or not; a text alone, which is a reading's, lists nothing."""
    if isinstance(entries, str):
        return []
    return list(entries.values()) if isinstance(entries, Mapping) else entries


def _check_split(split: str, settings: Settings) -> None:
    naming.check_split(split, duration_days=settings.values["duration_days"])


def _check_days(days: Sequence[float], settings: Settings) -> None:
    """Raise InputError unless the days ascend and lie within the run."""
    (first, last), duration = days, settings.values["duration_days"]
    if not first < last <= duration:
        raise InputError(
            f"expected ascending days up to duration_days, {duration:g}, got {first:g} and {last:g}"
        )


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
    if "propertyNames" in error.absolute_schema_path:
        key = (*key, value)  # what is wrong is a name, which the path of an error leaves out
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
    "minLength": "text of at least {} letter",
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
