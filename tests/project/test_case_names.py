"""Tests are the same ones in every process that collects them, and their names say what they are."""

import re

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


def test_workers_that_collect_other_names_run_nothing(pytester, monkeypatch):
    """So each run of all tests on two cores compares two collections, each by a hash seed of its own."""
    monkeypatch.delenv("PYTHONHASHSEED", raising=False)
    pytester.makepyfile(
        "import pytest\n"
        "@pytest.mark.parametrize('case', {f'case{k}' for k in range(50)})\n"
        "def test_case(case):\n"
        "    pass\n"
    )
    done = pytester.runpytest_subprocess("--numprocesses=2", "-p", "no:cacheprovider")
    assert done.ret != 0
    assert "Different tests were collected between" in done.stdout.str()
    assert " passed" not in done.stdout.str()


def test_names_hold_no_path_of_this_clone(request):
    names = [item.nodeid for item in request.session.items]
    assert not [name for name in names if re.search(rf"[-\[]{re.escape(str(REPOSITORY))}/", name)]


def test_drawn_cases_are_the_same_on_any_machine():
    assert settings.default.derandomize
    assert settings.default.deadline is None
