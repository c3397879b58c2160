"""Values that tests share stay as they were made: an edit in place would reach every test after it.

A fixture wider than one test is compared with itself when it ends, and what `made_once` functions gave after
each test module.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache, wraps

import numpy as np
import pandas as pd
import pytest

_GIVEN = {}


def digest(value):
    """Digest of the numbers and texts in a value: a table, an array, or what holds such."""
    found = hashlib.blake2b(digest_size=16)
    for part in _parts(value):
        found.update(part)
    return found.digest()


def _parts(value):
    if isinstance(value, pd.DataFrame):
        yield from _parts(
            {"index": value.index.to_numpy()} | {name: value[name].to_numpy() for name in value}
        )
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype} {value.shape}".encode()
        yield repr(value.tolist()).encode() if value.dtype == object else value.tobytes()
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield repr(name).encode()
            yield from _parts(part)
    elif isinstance(value, tuple | list):
        for part in value:
            yield from _parts(part)
    elif is_dataclass(value) and not isinstance(value, type):
        yield from _parts({field.name: getattr(value, field.name) for field in fields(value)})
    elif isinstance(value, str | int | float | None):
        yield repr(value).encode()


def made_once(function):
    """A function that gives the same value each time, which no test may change."""

    @cache
    @wraps(function)
    def once(*arguments, **options):
        value = function(*arguments, **options)
        call = ", ".join(map(repr, [*arguments, *options.values()]))
        _GIVEN[f"{function.__name__}({call})"] = value, digest(value)
        return value

    return once


def changed():
    """Names of the `made_once` calls whose value is no longer what it was; each is told once."""
    names = [name for name, (value, before) in _GIVEN.items() if digest(value) != before]
    for name in names:
        value, _ = _GIVEN[name]
        _GIVEN[name] = value, digest(value)
    return names


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef, request):
    """Compare a fixture that tests share with itself when it ends."""
    value = yield
    if fixturedef.scope != "function":
        before = digest(value)

        def compare():
            assert digest(value) == before, f"a test changed the fixture {fixturedef.argname} in place"

        request.addfinalizer(compare)
    return value


@pytest.fixture(scope="module", autouse=True)
def shared_values_stay():
    """Raise where a test of the module changed what a `made_once` function gave."""
    yield
    names = changed()
    assert not names, f"tests of this module changed in place: {', '.join(names)}"
