"""Two folders of results side by side: which tables, texts and figures differ.

    python -m validation.folders BEFORE AFTER

Tables are compared column by column, PNG figures pixel by pixel, all else byte by byte. Logs, benchmarks and
the metadata of tables are left out: times and digests of settings differ between runs that are the same.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib.image
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from opml.base.errors import InputError

LEFT_OUT = ("logs", "benchmarks")
"""Folders of results that tell of the run, not of what it computed."""

KINDS = {"tables": (".parquet",), "texts": (".md", ".tsv", ".html"), "figures": (".png", ".pdf")}
"""What a summary counts, by suffix; files with another suffix count as `other`."""


@dataclass
class Comparison:
    """What two folders have in common and where they differ; paths are relative to the folders."""

    same: Counter[str] = field(default_factory=Counter)
    different: Counter[str] = field(default_factory=Counter)
    differences: list[str] = field(default_factory=list)
    new_columns: list[str] = field(default_factory=list)
    only_before: list[str] = field(default_factory=list)
    only_after: list[str] = field(default_factory=list)

    @property
    def agrees(self) -> bool:
        """Whether `after` holds all that `before` holds, with the same content."""
        return not (self.differences or self.only_before)


def compare(before: Path, after: Path) -> Comparison:
    """Compare two folders. Raises InputError where one holds no results."""
    earlier, later = results(before), results(after)
    comparison = Comparison(only_before=sorted(earlier - later), only_after=sorted(later - earlier))
    for name in sorted(earlier & later):
        found = differences(before / name, after / name)
        comparison.differences += [f"{name}: {difference}" for difference in found]
        comparison.new_columns += [f"{name}: {column}" for column in new_columns(before / name, after / name)]
        (comparison.different if found else comparison.same)[kind(name)] += 1
    return comparison


def results(folder: Path) -> set[str]:
    """Return the paths of the results in a folder, relative to it. Raises InputError where there are none."""
    paths = [path.relative_to(folder) for path in folder.rglob("[!.]*") if path.is_file()]
    names = {path.as_posix() for path in paths if not set(LEFT_OUT) & set(path.parts)}
    if not names:
        raise InputError(f"{folder}: expected a folder of results, got none")
    return names


def kind(name: str) -> str:
    """Return what a file counts as in the summary."""
    return next((kind for kind, suffixes in KINDS.items() if Path(name).suffix in suffixes), "other")


def differences(before: Path, after: Path) -> list[str]:
    """Return what differs between two files, in words; nothing where they hold the same."""
    if before.read_bytes() == after.read_bytes():
        return []
    return _BY_CONTENT.get(before.suffix, _other_bytes)(before, after)


def new_columns(before: Path, after: Path) -> list[str]:
    """Return the columns that only the later of two tables has; none where one cannot be read."""
    if before.suffix != ".parquet" or before.read_bytes() == after.read_bytes():
        return []
    try:
        names = [pq.read_schema(path).names for path in (before, after)]
    except (pa.ArrowException, OSError):
        return []
    return [name for name in names[1] if name not in names[0]]


def _other_bytes(before: Path, after: Path) -> list[str]:
    sizes = [path.stat().st_size for path in (before, after)]
    return [f"other bytes ({sizes[0]} before, {sizes[1]} after)"]


def _other_pixels(before: Path, after: Path) -> list[str]:
    try:
        earlier, later = (matplotlib.image.imread(path) for path in (before, after))
    except (OSError, SyntaxError, ValueError) as reason:
        return [f"cannot be read ({reason})"]
    if earlier.shape != later.shape:
        return [f"{_size(earlier)} pixels before, {_size(later)} after"]
    height, width = earlier.shape[:2]
    changed = np.count_nonzero((earlier != later).reshape(height, width, -1).any(axis=-1))
    return [f"{changed} of {height * width} pixels differ"] if changed else []


def _size(image: np.ndarray) -> str:
    return f"{image.shape[1]} x {image.shape[0]}"


def _other_columns(before: Path, after: Path) -> list[str]:
    try:
        earlier, later = (pq.ParquetFile(path).read(use_threads=False) for path in (before, after))
    except (pa.ArrowException, OSError) as reason:
        return [f"cannot be read ({reason})"]
    if earlier.num_rows != later.num_rows:
        return [f"{earlier.num_rows} rows before, {later.num_rows} after"]
    return list(_column_differences(earlier, later))


def _column_differences(before: pa.Table, after: pa.Table) -> Iterator[str]:
    for name in before.column_names:
        if name not in after.column_names:
            yield f"{name}: column of before alone"
        elif before[name].type != after[name].type:
            yield f"{name}: {before[name].type} before, {after[name].type} after"
        elif difference := _value_difference(before[name].to_numpy(), after[name].to_numpy()):
            yield f"{name}: {difference}"


def _value_difference(before: np.ndarray, after: np.ndarray) -> str:
    """Return how many of two columns' values differ, and by how much; '' where none does. NaN equals NaN."""
    unequal = before != after
    if np.issubdtype(before.dtype, np.floating):
        unequal &= ~(np.isnan(before) & np.isnan(after))
    changed = np.count_nonzero(unequal)
    if not changed:
        return ""
    return f"{changed} of {len(before)} rows differ{_largest_step(before[unequal], after[unequal])}"


def _largest_step(before: np.ndarray, after: np.ndarray) -> str:
    """Return by how much real numbers differ at most; '' for all else, which has no distance."""
    if not np.issubdtype(before.dtype, np.floating):
        return ""
    steps = np.abs(after - before)
    return f", by up to {np.nanmax(steps):.3g}" if not np.isnan(steps).all() else ""


_BY_CONTENT: dict[str, Callable[[Path, Path], list[str]]] = {
    ".parquet": _other_columns,
    ".png": _other_pixels,
}


def summary(comparison: Comparison) -> str:
    """Return a comparison as lines to print: counts by kind, then each difference."""
    counts = [f"{'':8}{'same':>8}{'different':>11}"]
    for name in (*KINDS, "other"):
        counts.append(f"{name:8}{comparison.same[name]:8}{comparison.different[name]:11}")
    lists = {
        "Different:": comparison.differences,
        "Columns of AFTER alone:": comparison.new_columns,
        "Files of BEFORE alone:": comparison.only_before,
        "Files of AFTER alone:": comparison.only_after,
    }
    listed = [line for head, lines in lists.items() if lines for line in _list(head, lines)]
    return "\n".join([*counts, *listed])


def _list(head: str, lines: Sequence[str]) -> list[str]:
    return ["", head, *(f"  {line}" for line in lines)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare two folders of results; return 1 where AFTER lacks a file or has another content."""
    parser = argparse.ArgumentParser(prog="python -m validation.folders", description=main.__doc__)
    parser.add_argument("before", type=Path, metavar="BEFORE")
    parser.add_argument("after", type=Path, metavar="AFTER")
    given = parser.parse_args(arguments)
    try:
        comparison = compare(given.before, given.after)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(summary(comparison))
    return 0 if comparison.agrees else 1


if __name__ == "__main__":
    sys.exit(main())
