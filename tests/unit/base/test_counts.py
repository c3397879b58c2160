"""Numbers of things in what a command tells."""

import pytest

from opml.base.progress import counted

COUNTS = {0: "0 objects", 1: "1 object", 2: "2 objects"}


@pytest.mark.parametrize("number", COUNTS)
def test_one_thing_is_no_plural(number):
    assert counted(number, "object") == COUNTS[number]
