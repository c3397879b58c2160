"""Tables of pages: pictures are drawn from them, and sentences are held to them."""

import csv
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from validation.case import ROOT


def rows(page: str, heading: str = "") -> list[list[str]]:
    """Return the cells of the tables under a heading of a page, or of all; page: `docs/learning`."""
    text = (ROOT / f"{page}.md").read_text(encoding="utf-8")
    if heading:
        text = text.partition(f"\n{heading}\n")[2].partition("\n## ")[0]
    lines = re.findall(r"^\| .* \|$", text, re.MULTILINE)
    return [[cell.strip() for cell in line[1:-1].split(" | ")] for line in lines]


def tsv(name: str) -> list[dict[str, str]]:
    """Return the rows of a table of docs/tables."""
    with (ROOT / "docs" / "tables" / f"{name}.tsv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def write_seasons(
    name: str,
    folder: Path,
    seasons: Mapping[str, str],
    rows_of: Callable[[pd.DataFrame, str], list[dict[str, Any]]],
) -> None:
    """Write a table of docs/tables from the residuals of the trees in the seasons of a run.

    folder: `residuals` of `validation.catalogue_seasons`; seasons: words by name
    """
    parts = (
        row
        for test, words in seasons.items()
        for row in rows_of(pd.read_parquet(folder / test / "trees.parquet"), words)
    )
    pd.DataFrame(parts).to_csv(ROOT / "docs" / "tables" / f"{name}.tsv", sep="\t", index=False)


def catalogue() -> dict[tuple[str, str], list[list[int]]]:
    """Return the medians of docs/learning.md by season and way: at 1, 3, 5 and 7 days the numbers of a cell.

    They are the median and, where stated, its interval, in % of SGP4's.
    """
    lines = tsv("seasons")
    table: dict[tuple[str, str], list[list[int]]] = {}
    for line in lines:
        for name, cell in line.items():
            if name.endswith("[%]") and cell != "n/a":
                numbers = [int(number) for number in re.findall(r"\d+", cell)]
                table.setdefault((line["season"], name.removesuffix(" [%]")), []).append(numbers)
    return table
