"""The notebook of docs/notebook.md: what the page shows under its code, the notebook has as outputs of cells.

    python -m validation.pages.notebook <folder>

takes the pictures that the code drew in a folder into docs/images, with fewer colours.
"""

import base64
import re
import sys
from pathlib import Path

import jupytext
import nbformat
from nbformat.v4 import new_notebook, new_output
from PIL import Image

from opml.base.files import replacing
from validation.case import ROOT

PAGE = ROOT / "docs" / "notebook.md"
NOTEBOOK = Path("docs/notebook.ipynb")

_KERNEL = {"name": "python3", "language": "python", "display_name": "Python 3"}
_PRINTED, _PICTURE = r"```text\n(?P<printed>.*?)^```\n*", r"!\[(?P<words>[^]]+)\]\((?P<file>[^)]+)\)\n*"
_SHOWN = re.compile(f"{_PRINTED}|{_PICTURE}", re.DOTALL | re.MULTILINE)
_COLORS = 64


def text() -> str:
    """Return the notebook as it is after a run."""
    cells: list[nbformat.NotebookNode] = []
    for cell in jupytext.read(PAGE).cells:
        if cell.cell_type == "code":
            cell.execution_count = 1 + sum(earlier.cell_type == "code" for earlier in cells)
        elif cells and cells[-1].cell_type == "code" and (shown := _SHOWN.match(cell.source)):
            cells[-1].outputs.append(_output(shown))
            cell.source = cell.source[shown.end() :]
        if cell.source:
            cell.update(id=str(len(cells)), metadata={})
            cells.append(cell)
    made = new_notebook(cells=cells, metadata={"kernelspec": _KERNEL, "language_info": {"name": "python"}})
    return nbformat.writes(made) + "\n"


def _output(shown: re.Match[str]) -> nbformat.NotebookNode:
    """Return what a page shows below a cell as the cell's output: what it printed, or a picture."""
    if (printed := shown["printed"]) is not None:
        return new_output("stream", name="stdout", text=printed)
    picture = base64.b64encode((PAGE.parent / shown["file"]).read_bytes()).decode()
    return new_output("display_data", data={"image/png": picture, "text/plain": shown["words"]})


def take(folder: Path) -> None:
    """Take the pictures of the page from a folder."""
    for shown in _SHOWN.finditer(PAGE.read_text(encoding="utf-8")):
        if shown["file"]:
            picture = PAGE.parent / shown["file"]
            few = Image.open(folder / picture.name).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
            with replacing(picture) as temporary:
                few.save(temporary, format="PNG", optimize=True)


if __name__ == "__main__":
    take(Path(sys.argv[1]))
