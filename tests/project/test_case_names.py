"""Tests are the same ones in every process that collects them, and their names say what they are."""

import os
import re
import subprocess
import sys

import pytest
from case_names import LINE
from hypothesis import settings
from support import REPOSITORY

pytest_plugins = ["pytester"]
CONFTEST = "from case_names import pytest_make_parametrize_id"


def collected(pytester, cases):
    """Output of the collection of a test with the given cases, and whether it succeeded."""
    pytester.makeconftest(CONFTEST)
    mark = f"@pytest.mark.parametrize('content', {cases})"
    pytester.makepyfile(f"import pytest\n{mark}\ndef test_it(content):\n    assert True\n")
    run = pytester.runpytest_inprocess("--collect-only", "-q", "-p", "no:cacheprovider")
    return run.stdout.str(), run.ret == 0


@pytest.mark.parametrize(
    ("case", "shown"),
    [("b'\\x1f'", r"b'\x1f'"), (f"'a' * {LINE + 1}", "'aaaa"), ("'two\\nlines'", r"'two\nlines'")],
    ids=["bytes", "long", "two lines"],
)
def test_a_case_without_a_name_is_refused(pytester, case, shown):
    output, done = collected(pytester, f"[{case}]")
    assert not done
    assert f"expected ids= or pytest.param(..., id=...) for a case of content, got {shown}" in output


@pytest.mark.parametrize(
    "cases",
    ["[pytest.param(b'\\x1f', id='gzip')]", "[b'\\x1f'], ids=['gzip']", f"['a' * {LINE}]", "['line\\n']"],
    ids=["named", "ids", "a line", "a line with its end"],
)
def test_a_case_with_a_name_is_collected(pytester, cases):
    output, done = collected(pytester, cases)
    assert done, output


def names(seed):
    """Names of all tests, in the order in which a new process collects them."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "--quiet", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [*command, "--assert=plain", "tests"],  # what no test needs here takes half of the time
        cwd=REPOSITORY,
        env=os.environ | {"PYTHONHASHSEED": str(seed)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    return [line for line in done.stdout.splitlines() if "::" in line]


def test_two_collections_are_the_same():
    first, second = names(1), names(2)  # one after the other: seconds apart
    assert first == second
    assert len(first) > 3000
    assert not [name for name in first if re.search(rf"[-\[]{re.escape(str(REPOSITORY))}/", name)]


def test_drawn_cases_are_the_same_on_any_machine():
    assert settings.default.derandomize
    assert settings.default.deadline is None
