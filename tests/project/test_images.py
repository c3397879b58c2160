"""Pictures of the documentation: each is on a page, and is what the code draws today."""

import importlib
import re
from fnmatch import fnmatch

import pytest
from PIL import Image
from support import REPOSITORY

from opml.base.errors import InputError
from validation.pictures import drawing_code, shrunk
from validation.pictures.__main__ import main

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


@pytest.mark.parametrize("image", NOTEBOOKS)
def test_the_notebook_draws_its_pictures(image):
    assert f'savefig("{image}"' in (REPOSITORY / "docs" / "notebook.md").read_text(encoding="utf-8")


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


def test_code_that_all_figures_share_counts(digest, monkeypatch):
    shared = digest(TEXT)
    monkeypatch.setattr(drawing_code, "ROOM", "another")
    assert digest(TEXT) != shared


def test_a_picture_is_small_and_states_its_code(tmp_path, monkeypatch):
    monkeypatch.setattr(shrunk, "IMAGES", tmp_path)
    Image.new("RGB", (2400, 900), "white").save(tmp_path / "large.png")
    shrunk.shrink(tmp_path / "large.png", tmp_path / "learning.png")
    with Image.open(tmp_path / "learning.png") as small:
        assert small.size == (1344, 504)
    assert shrunk.stated_digest(tmp_path / "learning.png") == drawing_code.digest(
        shrunk.drawers()["learning.png"]
    )
    assert shrunk.stated_digest(tmp_path / "large.png") is None


def test_a_picture_that_nobody_draws_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"docs/images/new\.png: expected a row of CONTRIBUTING\.md"):
        shrunk.shrink(tmp_path / "large.png", shrunk.IMAGES / "new.png")


def test_a_folder_of_figures_becomes_the_listed_pictures(tmp_path, monkeypatch):
    figures, pictures = tmp_path / "figs", tmp_path / "images"
    (pictures / "paper").mkdir(parents=True)
    figures.mkdir()
    monkeypatch.setattr(shrunk, "IMAGES", pictures)
    for name in shrunk.drawers():
        if name.startswith("paper/"):
            Image.new("RGB", (20, 10), "white").save(figures / name.removeprefix("paper/"))
    Image.new("RGB", (20, 10), "white").save(figures / "unlisted.png")
    main([str(figures), str(pictures / "paper")])
    made = {path.relative_to(pictures).as_posix() for path in pictures.rglob("*.png")}
    assert made == {name for name in shrunk.drawers() if name.startswith("paper/")}
    (figures / "rso_grid.png").unlink()
    with pytest.raises(
        SystemExit, match=r"opml: .*rso_grid\.png: expected a figure of a finished run, got none"
    ):
        main([str(figures), str(pictures / "paper")])
