"""Pictures of the documentation: each is on a page, and is what the code draws today."""

import importlib
import re
from fnmatch import fnmatch

import pytest
from support import REPOSITORY

from validation.pictures import drawing_code, shrunk

IMAGES = sorted(path.relative_to(shrunk.IMAGES).as_posix() for path in shrunk.IMAGES.rglob("*.*"))
NOTEBOOKS = [image for image in IMAGES if image.startswith("notebook_")]
DRAWN = [image for image in IMAGES if image not in NOTEBOOKS]
PAGES = [REPOSITORY / "README.md", *(REPOSITORY / "docs").glob("*.md")]
ROWS = [
    [cell.strip() for cell in line.strip("| ").split(" | ")]
    for line in (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    if "`docs/images/" in line
]


def command(image):
    """Return what CONTRIBUTING.md tells of how a picture is drawn."""
    named = [(row, pattern) for row in ROWS for pattern in re.findall(r"`docs/images/([^`]+)`", row[0])]
    (row,) = [row for row, pattern in named if fnmatch(image, pattern)]
    return row[1]


@pytest.mark.parametrize("image", IMAGES)
def test_each_picture_is_on_a_page(image):
    name = image.removeprefix("paper/").removesuffix(".png")
    shown = rf"!\[[^\]]+\]\([\w/]*images/{image}\)|^{name} \w+\.\w+"
    assert any(re.search(shown, page.read_text("utf-8"), re.MULTILINE) for page in PAGES)


@pytest.mark.parametrize("image", IMAGES)
def test_each_picture_has_a_command(image):
    assert "`" in command(image)


def test_each_row_is_of_a_picture_that_is_there():
    named = [pattern for row in ROWS for pattern in re.findall(r"`docs/images/([^`]+)`", row[0])]
    assert [pattern for pattern in named if not any(fnmatch(image, pattern) for image in IMAGES)] == []
    assert sorted(shrunk.drawers()) == DRAWN


@pytest.mark.parametrize("image", DRAWN)
def test_each_picture_is_what_the_code_draws_today(image):
    function = shrunk.drawers()[image]
    module, name = function.rsplit(".", 1)
    assert callable(getattr(importlib.import_module(module), name))
    drawn = shrunk.stated_digest(shrunk.IMAGES / image) == drawing_code.digest(function)
    assert drawn, f"{function} has changed since docs/images/{image} was drawn: {command(image)}"


def test_pictures_are_small():
    sizes = {image: (shrunk.IMAGES / image).stat().st_size for image in IMAGES}
    assert sum(size for image, size in sizes.items() if image.startswith("paper/")) < 2.1e6
    assert {image: size for image, size in sizes.items() if size > 170e3} == {}


TEXT = """
from opml.figures.style import MUTED, legend
SIZE = 3
def draw(axes):
    axes.plot(_points(), color=MUTED)
def _points():
    return SIZE
def other():
    return 5
"""


@pytest.fixture
def digest(tmp_path, monkeypatch):
    """Return what gives the digest of `draw` in a module of a text."""
    monkeypatch.syspath_prepend(tmp_path)

    def of_text(text):
        drawing_code.module_names.cache_clear()
        (tmp_path / "drawing_of_a_test.py").write_text(text, encoding="utf-8")
        importlib.invalidate_caches()
        return drawing_code.digest("drawing_of_a_test.draw")

    return of_text


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("return SIZE", "return SIZE  # metres"),
        ("(axes):", '(axes):\n    """Draw it."""'),
        ("return 5", "return 6"),
        ("SIZE = 3", 'SIZE = 3\n"""Points of the line."""'),
        ("_points(), color", "_points(),\n        color"),
    ],
    ids=["comment", "docstring", "another function", "meaning of a constant", "layout"],
)
def test_what_changes_no_drawing_changes_no_digest(digest, old, new):
    assert digest(TEXT.replace(old, new)) == digest(TEXT)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("SIZE = 3", "SIZE = 4"),
        ("return SIZE", "return -SIZE"),
        ("=MUTED", "='red'"),
        ("3\n", "3\nprint(3)\n"),
    ],
    ids=["constant", "helper", "color", "on import"],
)
def test_what_changes_a_drawing_changes_the_digest(digest, old, new):
    assert digest(TEXT.replace(old, new)) != digest(TEXT)
