"""Pages that are written from what the package declares."""

import pytest
from support import REPOSITORY

from validation.pages.__main__ import PAGES


@pytest.mark.parametrize("path", PAGES, ids=str)
def test_pages_are_those_of_the_package(path):
    written = (REPOSITORY / path).read_text(encoding="utf-8")
    assert written == PAGES[path](), "run: python -m validation.pages"
