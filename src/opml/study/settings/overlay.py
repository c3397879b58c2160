"""Settings as files laid over each other, and which of them set a value."""

import operator
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import reduce
from typing import Any

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.yaml_files import read_yaml

Key = tuple[str | int, ...]

MISSING = object()  # what stands under a key that is not there

COMMAND_LINE = "--config"


@dataclass(frozen=True)
class Layer:
    """Values, and the file or option that they come from."""

    name: str
    values: Any


@dataclass(frozen=True)
class Source:
    """Merged values and the layers that they were merged from, later ones on top."""

    values: Mapping[str, Any]
    layers: Sequence[Layer]
    has_default_study: bool = False  # the first file alone says what is asked, and nothing laid over it

    def wrong(self, key: Key, what: str) -> InputError:
        """Return the error about a key, with the file that set it."""
        return InputError(f"{self.origin(key)}: {'.'.join(map(str, key))}: {what}")

    @contextmanager
    def naming(self, key: Key) -> Iterator[None]:
        """Name a key, and the file that set it, in the InputError of what is looked at."""
        try:
            yield
        except InputError as error:
            raise self.wrong(key, str(error)) from None

    def origin(self, key: Key) -> str:
        """Return the name of the layer that set a key, for a missing key of that which set what it is in."""
        value = value_at(self.values, key)
        if value is MISSING:
            setting = [layer.name for layer in self.layers if value_at(layer.values, key[:-1]) is not MISSING]
            return setting[-1] if setting else "settings"
        for layer in reversed(self.layers):
            if _sets(value_at(layer.values, key), value):
                return layer.name
        return COMMAND_LINE


def read_layer(path: FilePath) -> Layer:
    """Read a file of settings; an empty one sets nothing. Raises InputError where it holds no mapping."""
    values = read_yaml(path)
    if values is None:
        values = {}
    if not isinstance(values, Mapping):
        raise InputError(f"{path}: expected a mapping of settings, got {type(values).__name__}")
    return Layer(str(path), values)


def laid_over(base: Any, top: Any) -> Any:
    """Return `base` with `top` over it: mappings key by key, all else replaced; `{}` empties a mapping."""
    if not (isinstance(base, Mapping) and isinstance(top, Mapping) and top):
        return top
    return {**base, **{key: laid_over(base.get(key, MISSING), value) for key, value in top.items()}}


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


def value_at(values: Any, key: Key) -> Any:
    """Return what stands under a key, MISSING if nothing does."""
    try:
        return reduce(operator.getitem, key, values)
    except (KeyError, IndexError, TypeError):
        return MISSING


def _sets(part: Any, whole: Any) -> bool:
    """Return whether a layer's value stands in a merged one; a mapping may be merged from several layers."""
    if isinstance(part, Mapping) and isinstance(whole, Mapping):
        return part == whole or any(_sets(value, whole.get(key, MISSING)) for key, value in part.items())
    return repr(part) == repr(whole)


def mappings(values: Mapping[str, Any], key: Key = ()) -> Iterator[Key]:
    """Yield the key of every mapping, the outermost first."""
    yield key
    for part, value in values.items():
        if isinstance(value, Mapping):
            yield from mappings(value, (*key, part))
