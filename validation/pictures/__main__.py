"""Shrink figures of a finished run into pictures of the documentation.

    python -m validation.pictures results/figs docs/images/paper
    python -m validation.pictures results/figs/scan.png docs/images/scan.png

Of a folder, those figures are taken that are listed as pictures of the other folder.
"""

import argparse
import sys
from pathlib import Path

from opml.base.errors import InputError
from validation.pictures import shrunk


def main(arguments: list[str] | None = None) -> None:
    """Shrink a figure, or those of a folder; arguments: of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("figures", type=Path, help="folder of figures, or one figure")
    parser.add_argument("pictures", type=Path, help="folder of pictures, or one picture")
    asked = parser.parse_args(arguments)
    pairs = [(asked.figures, asked.pictures)]
    if asked.figures.is_dir():
        folder = asked.pictures.resolve()
        listed = (shrunk.IMAGES / name for name in shrunk.drawers())
        pairs = [(asked.figures / path.name, path) for path in listed if path.parent == folder]
    try:
        for figure, picture in pairs:
            shrunk.shrink(figure, picture)
            print(picture)
    except InputError as error:
        sys.exit(f"opml: {error}")


if __name__ == "__main__":
    main()
