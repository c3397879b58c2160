"""Tables of pages: pictures are drawn from them, and sentences are held to them."""

import csv
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
    """Return the medians of docs/learning.md by season and way: at 1, 3, 5 and 7 days the numbers of a cell.

    They are the median and, where stated, its interval, in % of SGP4's.
    """
    with (ROOT / "docs" / "tables" / "seasons.tsv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file, delimiter="\t"))
    table: dict[tuple[str, str], list[list[int]]] = {}
    for line in lines:
        for name, cell in line.items():
            if name.endswith("[%]") and cell != "-":
                numbers = [int(number) for number in re.findall(r"\d+", cell)]
                table.setdefault((line["season"], name.removesuffix(" [%]")), []).append(numbers)
    return table
