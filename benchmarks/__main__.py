"""opml beside its peers, and what it costs by itself: writes benchmarks/results.md.

python -m benchmarks [--orekit-data DIR] [--only race fits precision scaling kernels svr paper]
                     [--results DIR]
"""

import argparse
import importlib.metadata
import os
import platform
import sys
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks import diagram, fits, kernels, paper, precision, race, scaling, sections, svr
from opml import __version__
from opml.base.errors import InputError

RESULTS = Path(__file__).with_name("results.md")
FIGURE = Path(__file__).parents[1] / "docs" / "images" / "work_precision.png"
TOOLS = ("orekit-jpype", "heyoka", "satkit", "brahe", "numba", "scikit-learn", "scikit-learn-intelex")
CATALOGUE = 30_000
"""RSOs of a whole catalogue."""

Made = tuple[dict[str, str], bool]
"""Texts of the report by their titles, and whether all tools' answers agree with opml's."""

INTRODUCTION = """# Benchmarks

Written by `make bench`. Only ratios mean much: every tool flew the same arcs in the same run, in turns, each
on one core unless said otherwise. Times are the processor's, not the clock's, where both are possible.

Machine of the last run: {machine}. Python {python}; {tools}.
"""


def main() -> int:
    """Run the benchmarks asked for; exit status 1 where a tool's answers disagree with opml's."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--orekit-data", type=Path, metavar="DIR", help="a copy of Orekit's data")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=list(SECTIONS))
    parser.add_argument("--rounds", type=int, default=race.ROUNDS, help="turns of each tool")
    parser.add_argument("--results", type=Path, default=Path("results"), help="a finished run of the paper")
    arguments = parser.parse_args()
    made, agreed = {}, True
    for name in arguments.only:
        texts, agrees = SECTIONS[name](arguments)
        made |= texts
        agreed = agreed and agrees
    page = RESULTS.read_text(encoding="utf-8") if RESULTS.exists() else ""
    RESULTS.write_text(sections.replaced(page, _introduction(), made), encoding="utf-8")
    _progress(f"wrote {RESULTS.name}")
    return 0 if agreed else 1


def _race(arguments: argparse.Namespace) -> Made:
    """Fly the same arcs by every tool."""
    results, absent = race.run(arguments.orekit_data, rounds=arguments.rounds, progress=_progress)
    text = (
        f"{race.ARCS} arcs of the paper's RSO, 7 days, 20x20 gravity, drag, third bodies: each tool's "
        "closest force model, stated below.\n\n"
    )
    text += race.report(results, absent)
    return {"Beside the peers": text}, not race.disagreements(results)


def _fits(arguments: argparse.Namespace) -> Made:
    """Fit the same tracks by every tool that has a batch least squares."""
    results, absent = fits.run(arguments.orekit_data, progress=_progress)
    return {"Fits beside the peers": fits.report(results, absent)}, not fits.disagreements(results)


def _precision(arguments: argparse.Namespace) -> Made:
    """Measure work against own error, each tool at five settings, and draw the figure."""
    panels, absent = precision.run(arguments.orekit_data, progress=_progress)
    diagram.save(diagram.work_precision(panels), FIGURE)
    _progress(f"wrote {FIGURE.name}")
    return {"Work and precision": precision.report(panels, absent)}, True


def _scaling(arguments: argparse.Namespace) -> Made:
    """Measure threads, arcs, RSOs, least squares and the start of a job."""
    sentence, cost = scaling.rsos(_progress)
    week = CATALOGUE * 7.0 * cost / 1000.0
    texts = {
        "Threads": scaling.threads(_progress),
        "Arcs": scaling.arcs(_progress),
        "RSOs": sentence
        + f"\nOn paper, {CATALOGUE} RSOs for seven days: {week / 60.0:.0f} minutes of one core, "
        f"{week / 60.0 / 64.0:.1f} minutes of a machine with 64, {week / 1000.0:.1f} seconds of a cluster "
        "with 1000, as arcs do not wait for each other.\n",
        "Least squares": scaling.least_squares(_progress),
        "Start of a job": scaling.start(_progress),
    }
    return texts, True


def _kernels(arguments: argparse.Namespace) -> Made:
    """Measure each kernel beside what its arithmetic must cost."""
    _progress("kernels")
    return {"Kernels": kernels.report()}, True


def _svr(arguments: argparse.Namespace) -> Made:
    """Measure support vector regression by two libraries."""
    _progress("support vector regression")
    return {"Support vector regression": svr.report()}, True


def _paper(arguments: argparse.Namespace) -> Made:
    """Tabulate the cost of the whole paper stage by stage, where it has been run."""
    try:
        text = paper.report(paper.costs(arguments.results))
    except InputError as reason:
        text = f"Left out: {reason}."
    return {"The whole paper": text}, True


SECTIONS: dict[str, Callable[[argparse.Namespace], Made]] = {
    "race": _race,
    "fits": _fits,
    "precision": _precision,
    "scaling": _scaling,
    "kernels": _kernels,
    "svr": _svr,
    "paper": _paper,
}


def _introduction() -> str:
    versions = {"opml": __version__} | {name: _version(name) for name in TOOLS}
    tools = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    machine = f"{_processor()}, {os.cpu_count()} cores"
    return INTRODUCTION.format(machine=machine, python=platform.python_version(), tools=tools)


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.machine()


def _progress(text: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
