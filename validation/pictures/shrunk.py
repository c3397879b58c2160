"""Pictures of the documentation: as large as a screen needs, with the digest of the code that drew them."""

import re
import tempfile
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from opml.base.errors import InputError
from opml.base.files import replacing
from opml.figures import style
from validation.case import ROOT
from validation.pictures.drawing_code import ROOM, digest

IMAGES = ROOT / "docs" / "images"
SCALE, COLORS = 0.56, 96
"""Size of a picture, in parts of the printed figure's, and how many colours it keeps."""

KEY = "digest of the code that drew it"
"""Of the text in a picture's file."""

_ROW = re.compile(r"`docs/images/(\w+\.png)`.*`(\w+(?:\.\w+)+)` draws")
_BLOCK = re.compile(r"```{run-figures}\n(.*?)```", re.DOTALL)


def drawers() -> dict[str, str]:
    """Return the functions that draw the pictures, by path below `docs/images`.

    A table of CONTRIBUTING.md names them; those of the paper's figures stand in docs/figures.md.
    """
    table, page = (
        (ROOT / path).read_text(encoding="utf-8") for path in ("CONTRIBUTING.md", "docs/figures.md")
    )
    lines = (line.split() for line in _BLOCK.search(page)[1].splitlines())
    paper = {f"paper/{name}.png": f"{ROOM}.{function}" for name, function, *_ in lines}
    return dict(_ROW.findall(table)) | paper


def shrink(figure: Path, picture: Path) -> None:
    """Write a figure as small as a screen needs it, with the digest of the code that draws it today.

    Raises InputError where there is no such figure, or no function is named that draws it.
    """
    name = picture.resolve().relative_to(IMAGES).as_posix()
    if name not in drawers():
        raise InputError(f"docs/images/{name}: expected a row of CONTRIBUTING.md on what draws it, got none")
    if not figure.is_file():
        raise InputError(f"{figure}: expected a figure of a finished run, got none")
    text = PngInfo()
    text.add_text(KEY, digest(drawers()[name]))
    with Image.open(figure) as whole:
        size = round(SCALE * whole.width), round(SCALE * whole.height)
        small = whole.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    with replacing(picture) as temporary:
        few = small.quantize(COLORS, Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE)
        few.save(temporary, format="PNG", optimize=True, pnginfo=text)


def save(figure: Figure, name: str) -> None:
    """Write a figure as the picture of a name, as `shrink` does."""
    with tempfile.TemporaryDirectory() as folder:
        large = Path(folder) / f"{name}.png"
        style.save_png(figure, large)
        shrink(large, IMAGES / large.name)


def stated_digest(picture: Path) -> str | None:
    """Return the digest that a picture's file states, None where it has none."""
    with Image.open(picture) as image:
        return image.info.get(KEY)
