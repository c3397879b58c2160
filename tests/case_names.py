"""Cases have names that are short and the same in every collection: where workers differ, no test runs."""

import pytest

LINE = 110


def pytest_make_parametrize_id(val, argname):
    """Refuse to make a name of bytes, which may hold a clock, or of more text than a line has."""
    is_long = isinstance(val, str) and (len(val) > LINE or "\n" in val.strip("\n"))
    if is_long or isinstance(val, bytes):
        wanted = "expected ids= or pytest.param(..., id=...)"
        pytest.fail(f"{wanted} for a case of {argname}, got {val[:40]!r}", pytrace=False)
