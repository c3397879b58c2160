"""Shrink figures of a finished run into pictures of the documentation.

    python -m validation.pictures results/figs docs/images/paper
    python -m validation.pictures results/figs/scan.png docs/images/scan.png

Of a folder, those figures are taken that are listed as pictures of the other folder.
"""

import argparse
from pathlib import Path

from validation.pictures.shrunk import IMAGES, drawers, shrink


def main() -> None:
    """Shrink a figure, or those of a folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("figures", type=Path, help="folder of figures, or one figure")
    parser.add_argument("pictures", type=Path, help="folder of pictures, or one picture")
    asked = parser.parse_args()
    pairs = [(asked.figures, asked.pictures)]
    if asked.figures.is_dir():
        listed = (IMAGES / name for name in drawers() if (IMAGES / name).parent == asked.pictures.resolve())
        pairs = [(asked.figures / picture.name, picture) for picture in listed]
    for figure, picture in pairs:
        shrink(figure, picture)
        print(picture)


if __name__ == "__main__":
    main()
