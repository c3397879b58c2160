"""What tests share stays as it was made: a test that changes it in place is told."""

import numpy as np
import pandas as pd
import pytest
import unchanged
from support import environment

pytest_plugins = ["pytester"]
CONFTEST = """
import pandas as pd
import pytest
from unchanged import made_once, pytest_fixture_setup, shared_values_stay

@pytest.fixture(scope="{scope}")
def table():
    return pd.DataFrame({{"t": [0.0, 60.0], "reason": ["", "decayed"]}})

@made_once
def made(days):
    return {{"truth": pd.DataFrame({{"t": [0.0, days]}})}}

@pytest.fixture
def truth():
    return made(3.0)["truth"]
"""


def outcomes(pytester, body, *, scope="session"):
    """Counts of passed tests and errors, and the output, of two tests of which the first does `body`."""
    pytester.makeconftest(CONFTEST.format(scope=scope))
    pytester.makepyfile(
        f"def test_first(table, truth):\n    {body}\ndef test_second(table, truth):\n    assert True\n"
    )
    run = pytester.runpytest_inprocess("-p", "no:cacheprovider")
    counts = run.parseoutcomes()
    return counts.get("passed", 0), counts.get("errors", 0), run.stdout.str()


@pytest.mark.parametrize("scope", ["session", "module"])
@pytest.mark.parametrize(
    "change",
    ["table['t'] += 1.0", "table.loc[0, 't'] = 1.0", "table.loc[0, 'reason'] = 'x'", "table.pop('t')"],
)
def test_a_change_of_a_fixture_is_told(pytester, change, scope):
    passed, errors, output = outcomes(pytester, change, scope=scope)
    assert (passed, errors) == (2, 1)
    assert "a test changed the fixture table in place" in output


def test_a_change_of_what_a_function_gave_is_told(pytester):
    passed, errors, output = outcomes(pytester, "truth['t'] = 5.0")
    assert (passed, errors) == (2, 1)
    assert "made(3.0)" in output


@pytest.mark.parametrize("use", ["table.assign(t=1.0)", "table.copy().pop('t')", "table['t'].to_numpy() + 1"])
def test_tests_that_only_read_pass(pytester, use):
    assert outcomes(pytester, use)[:2] == (2, 0)


def test_a_fixture_of_one_test_may_be_changed(pytester):
    assert outcomes(pytester, "table['t'] += 1.0", scope="function")[:2] == (2, 0)


def test_every_kind_of_value_is_looked_into():
    value = {"table": pd.DataFrame({"x": [1.0]}), "list": [np.zeros(2), (np.ones(2), "text")]}
    before = unchanged.digest(value)
    assert unchanged.digest(value) == before
    value["list"][1][0][1] = 2.0
    assert unchanged.digest(value) != before


def test_the_environment_is_made_once():
    assert environment() is environment()
    assert unchanged.changed() == []
