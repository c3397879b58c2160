"""docs/notebook.md: it is a notebook, prints what the page says, and draws the figures that it shows."""

import base64
import contextlib
import io
import re

import matplotlib
import nbformat
import numpy as np
import pytest
from PIL import Image, ImageChops
from support import REPOSITORY

from validation.pages import notebook

PAGE = REPOSITORY / "docs" / "notebook.md"
TEXT = PAGE.read_text(encoding="utf-8")
CELLS = re.findall(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```\n)?", TEXT, re.MULTILINE | re.DOTALL)

FAR = 1.0
"""Mean difference of two pictures' colours, of 255: more than another processor's last digits make."""


PICTURES = re.findall(r"\]\(images/([^)]+)\)", TEXT)


def test_the_notebook_has_what_its_cells_print_and_draw():
    book = nbformat.read(PAGE.with_suffix(".ipynb"), as_version=4)
    nbformat.validate(book)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    outputs = [output for cell in code for output in cell.outputs]
    assert [cell.source for cell in code] == [text.strip() for text, _ in CELLS]
    assert ["".join(output.get("text", "") for output in cell.outputs) for cell in code] == [
        shown for _, shown in CELLS
    ]
    drawn = [base64.b64decode(output.data["image/png"]) for output in outputs if "data" in output]
    assert drawn == [(PAGE.parent / "images" / name).read_bytes() for name in PICTURES]


def test_pictures_that_the_code_drew_become_those_of_the_page(tmp_path, monkeypatch):
    monkeypatch.setattr(notebook, "PAGE", tmp_path / "page.md")
    notebook.PAGE.write_text("![words](one.png)\n", encoding="utf-8")
    drawn = Image.effect_noise((99, 99), 50.0).convert("RGBA")
    (tmp_path / "drawn").mkdir()
    drawn.save(tmp_path / "drawn" / "one.png")
    notebook.take(tmp_path / "drawn")
    taken = Image.open(tmp_path / "one.png")
    assert len(taken.getcolors()) <= 64
    assert np.mean(ImageChops.difference(taken.convert("RGB"), drawn.convert("RGB"))) < 2.0


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """What each cell prints, and the folder that the notebook ran in."""
    folder, names, printed = tmp_path_factory.mktemp("notebook"), {}, []
    with contextlib.chdir(folder), matplotlib.rc_context({**matplotlib.rcParamsDefault, "backend": "agg"}):
        for code, _ in CELLS:
            with contextlib.redirect_stdout(io.StringIO()) as output:
                exec(code, names)
            printed.append(output.getvalue())
        names["plt"].close("all")
    return printed, folder


@pytest.mark.slow
def test_each_cell_prints_what_the_page_says(run):
    assert run[0] == [shown for _, shown in CELLS]
    assert sum(map(bool, run[0])) >= 5


@pytest.mark.slow
def test_the_figures_that_it_draws_are_those_of_the_page(run):
    assert sorted(path.name for path in run[1].iterdir()) == sorted(PICTURES)
    for name in PICTURES:
        drawn, committed = (
            Image.open(folder / name).convert("RGB") for folder in (run[1], PAGE.parent / "images")
        )
        assert drawn.size == committed.size, name
        assert np.mean(ImageChops.difference(drawn, committed)) < FAR, (
            f"{name}: draw it as CONTRIBUTING.md says"
        )
