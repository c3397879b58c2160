"""Pictures of the documentation: each is on a page, and CONTRIBUTING.md tells what draws it."""

import importlib
import re
from fnmatch import fnmatch

import pytest
from support import REPOSITORY

IMAGES = sorted(path.name for path in (REPOSITORY / "docs" / "images").iterdir())
PAGES = [REPOSITORY / "README.md", *(REPOSITORY / "docs").glob("*.md")]
NOTEBOOK = (REPOSITORY / "docs" / "notebook.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("| ").split(" | ")]
    for line in (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    if "`docs/images/" in line
]


def rows_of(image):
    """Return the rows of CONTRIBUTING.md that tell how a picture is drawn."""
    named = [(row, pattern) for row in ROWS for pattern in re.findall(r"`docs/images/([^`]+)`", row[0])]
    return [row for row, pattern in named if fnmatch(image, pattern)]


@pytest.mark.parametrize("image", IMAGES)
def test_each_picture_is_on_a_page(image):
    assert any(re.search(rf"!\[[^\]]+\]\([\w/]*images/{image}\)", page.read_text("utf-8")) for page in PAGES)


@pytest.mark.parametrize("image", IMAGES)
def test_each_picture_has_a_command_and_a_function_that_draws_it(image):
    (row,) = rows_of(image)
    assert "`" in row[1]
    drawer = re.search(r"`(\w+(?:\.\w+)*)\.(\w+)` draws", row[1])
    if drawer is None:
        assert f'savefig("{image}"' in NOTEBOOK
    else:
        assert callable(getattr(importlib.import_module(drawer[1]), drawer[2]))


def test_each_row_is_of_a_picture_that_is_there():
    named = [pattern for row in ROWS for pattern in re.findall(r"`docs/images/([^`]+)`", row[0])]
    assert [pattern for pattern in named if not any(fnmatch(image, pattern) for image in IMAGES)] == []
