"""docs/notebook.md: it is a notebook, prints what the page says, and draws the figures that it shows."""

import contextlib
import io
import re

import jupytext
import matplotlib
import numpy as np
import pytest
from PIL import Image, ImageChops
from support import REPOSITORY

PAGE = REPOSITORY / "docs" / "notebook.md"
TEXT = PAGE.read_text(encoding="utf-8")
CELLS = re.findall(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```\n)?", TEXT, re.MULTILINE | re.DOTALL)

FAR = 1.0
"""Mean difference of two pictures' colours, of 255: more than another processor's last digits make."""


def cells(path):
    """Kind and text of each cell of a notebook."""
    return [(cell.cell_type, cell.source) for cell in jupytext.read(path).cells]


def test_the_page_is_a_notebook_of_the_same_code():
    assert [text for kind, text in cells(PAGE) if kind == "code"] == [code.strip() for code, _ in CELLS]


def test_the_notebook_is_that_of_the_page():
    assert cells(PAGE.with_suffix(".ipynb")) == cells(PAGE), "run jupytext as CONTRIBUTING.md tells"


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
    shown = re.findall(r"\]\(images/([^)]+)\)", TEXT)
    assert sorted(path.name for path in run[1].iterdir()) == sorted(shown)
    for name in shown:
        drawn, committed = (
            Image.open(folder / name).convert("RGB") for folder in (run[1], PAGE.parent / "images")
        )
        assert drawn.size == committed.size, name
        assert np.mean(ImageChops.difference(drawn, committed)) < FAR, (
            f"{name}: run jupytext as CONTRIBUTING.md tells"
        )
