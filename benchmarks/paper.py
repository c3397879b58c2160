"""What a finished run cost, stage by stage, from the benchmarks that its jobs left.

    python -m benchmarks.paper [RESULTS]

Snakemake looks at a job twice a second, and not any more once it has ended: of each job up to half a second
of processor time is missing. Its own time is no job's; `time snakemake` tells it.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from opml.base.errors import InputError

STAGES = {
    "environment": "environment",
    "truth": "truth",
    "tracking": "tracks",
    "estimates": "estimation",
    "predictions": "prediction",
    "dataset": "dataset",
    "models": "training",
    "evaluation": "evaluation",
}
"""Stages by the folder of their benchmarks; all else draws or tells."""

REST = "figures, tables, all else"


@dataclass(frozen=True)
class Cost:
    """Jobs of a stage, and the processor and wall time of all of them [s]."""

    stage: str
    jobs: int
    processor: float
    wall: float


def costs(results: Path) -> list[Cost]:
    """Return what each stage of a finished run cost, in its order, and all together.

    Raises InputError where `results` holds no benchmarks or one cannot be read.
    """
    folder = results / "benchmarks"
    marks = [_mark(path, path.relative_to(folder).parts[0]) for path in sorted(folder.rglob("*.tsv"))]
    if not marks:
        raise InputError(f"{folder}: expected the benchmarks of a finished run, got none")
    table = pd.DataFrame(marks, columns=["stage", "processor", "wall"])
    named = [(stage, table[table["stage"] == stage]) for stage in (*STAGES.values(), REST)]
    return [_cost(stage, rows) for stage, rows in (*named, ("together", table)) if len(rows)]


def _mark(path: Path, folder: str) -> tuple[str, float, float]:
    """Return stage, processor and wall time [s] of a job; the wall time twice where there is no other."""
    try:
        row = pd.read_csv(path, sep="\t").iloc[-1]
        return STAGES.get(folder, REST), float(row["cpu_time"] or row["s"]), float(row["s"])
    except (KeyError, ValueError, IndexError) as reason:
        raise InputError(f"{path}: expected a benchmark with cpu_time and s, got {reason}") from None


def _cost(stage: str, rows: pd.DataFrame) -> Cost:
    return Cost(stage, len(rows), float(rows["processor"].sum()), float(rows["wall"].sum()))


def report(found: Sequence[Cost]) -> str:
    """Return a table in Markdown, one row for each stage."""
    head = ["| stage | jobs | core-seconds | a job [s] | core-minutes |", "| --- | --- | --- | --- | --- |"]
    rows = [
        f"| {one.stage} | {one.jobs} | {one.processor:.0f} | {one.processor / one.jobs:.2f} "
        f"| {one.processor / 60.0:.1f} |"
        for one in found
    ]
    return "\n".join([*head, *rows])


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what a finished run cost."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.paper", description=main.__doc__)
    parser.add_argument("results", type=Path, nargs="?", default=Path("results"), metavar="RESULTS")
    try:
        print(report(costs(parser.parse_args(arguments).results)))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
