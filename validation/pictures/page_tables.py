"""Tables of pages: pictures are drawn from them, and sentences are held to them."""

import re

from validation.case import ROOT


def rows(page: str, heading: str = "") -> list[list[str]]:
    """Return the cells of the tables under a heading of a page, or of all; page: `docs/learning`."""
    text = (ROOT / f"{page}.md").read_text(encoding="utf-8")
    if heading:
        text = text.partition(f"\n{heading}\n")[2].partition("\n## ")[0]
    lines = re.findall(r"^\| .* \|$", text, re.MULTILINE)
    return [[cell.strip() for cell in line[1:-1].split(" | ")] for line in lines]


def catalogue() -> dict[tuple[str, str], list[list[int]]]:
    """Return the table of docs/learning.md by season and way: at 1, 3, 5 and 7 days the numbers of a cell.

    They are the median, the 95th percentile and, where stated, the interval of the median, in % of SGP4's.
    """
    table, season = {}, ""
    for first, way, *cells in rows("docs/learning", "## Results")[2:]:
        season = first or season
        table[season, way.strip("*")] = [[int(n) for n in re.findall(r"\d+", cell)] for cell in cells]
    return table
