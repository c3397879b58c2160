"""opml beside its peers, and what it costs by itself: writes benchmarks/results.md.

python -m benchmarks [--orekit-data DIR] [--only race scaling kernels svr paper] [--results DIR]
"""

import argparse
import importlib.metadata
import os
import platform
import sys
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks import kernels, paper, race, scaling, svr
from opml.errors import InputError

RESULTS = Path(__file__).with_name("results.md")
TOOLS = ("opml", "orekit-jpype", "heyoka", "satkit", "numba", "scikit-learn", "scikit-learn-intelex")
CATALOGUE = 30_000
"""RSOs of a whole catalogue."""

INTRODUCTION = """# Benchmarks

Written by `make bench`. Only ratios mean much: every tool flew the same arcs in the same run, in turns, each
on one core unless said otherwise. Times are the processor's, not the clock's, where both are possible.

Machine: {machine}. Python {python}; {tools}.
"""


def main() -> int:
    """Run the benchmarks asked for; exit status 1 where a tool's answers disagree with opml's."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--orekit-data", type=Path, metavar="DIR", help="a copy of Orekit's data")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=list(SECTIONS))
    parser.add_argument("--rounds", type=int, default=race.ROUNDS, help="turns of each tool")
    parser.add_argument("--results", type=Path, default=Path("results"), help="a finished run of the paper")
    arguments = parser.parse_args()
    parts, agreed = [_introduction()], True
    for name in arguments.only:
        text, agrees = SECTIONS[name](arguments)
        parts.append(text)
        agreed = agreed and agrees
    RESULTS.write_text("\n".join(parts), encoding="utf-8")
    _progress(f"wrote {RESULTS.name}")
    return 0 if agreed else 1


def _race(arguments: argparse.Namespace) -> tuple[str, bool]:
    """The same arcs by every tool."""
    results, absent = race.run(arguments.orekit_data, rounds=arguments.rounds, progress=_progress)
    text = (
        f"## Beside the peers\n\n{race.ARCS} arcs of the paper's RSO, 7 days, 20x20 gravity, drag, third "
        "bodies: each tool's closest force model, stated below.\n\n"
    )
    return text + race.report(results, absent), not race.disagreements(results)


def _scaling(arguments: argparse.Namespace) -> tuple[str, bool]:
    """Threads, arcs, RSOs, least squares, the start of a job."""
    sentence, cost = scaling.rsos(_progress)
    week = CATALOGUE * 7.0 * cost / 1000.0
    parts = {
        "Threads": scaling.threads(_progress),
        "Arcs": scaling.arcs(_progress),
        "RSOs": sentence
        + f"\nOn paper, {CATALOGUE} RSOs for seven days: {week / 60.0:.0f} minutes of one core, "
        f"{week / 60.0 / 64.0:.1f} minutes of a machine with 64, {week / 1000.0:.1f} seconds of a cluster "
        "with 1000, as arcs do not wait for each other.\n",
        "Least squares": scaling.least_squares(_progress),
        "Start of a job": scaling.start(_progress),
    }
    return "\n".join(f"## {title}\n\n{text}" for title, text in parts.items()), True


def _kernels(arguments: argparse.Namespace) -> tuple[str, bool]:
    """Each kernel beside what its arithmetic must cost."""
    _progress("kernels")
    return "## Kernels\n\n" + kernels.report(), True


def _svr(arguments: argparse.Namespace) -> tuple[str, bool]:
    """Support vector regression by two libraries."""
    _progress("support vector regression")
    return "## Support vector regression\n\n" + svr.report(), True


def _paper(arguments: argparse.Namespace) -> tuple[str, bool]:
    """The whole paper stage by stage, where it has been run."""
    try:
        text = paper.report(paper.costs(arguments.results))
    except InputError as reason:
        text = f"Left out: {reason}."
    return f"## The whole paper\n\n{text}\n", True


SECTIONS: dict[str, Callable[[argparse.Namespace], tuple[str, bool]]] = {
    "race": _race,
    "scaling": _scaling,
    "kernels": _kernels,
    "svr": _svr,
    "paper": _paper,
}


def _introduction() -> str:
    tools = ", ".join(f"{name} {version}" for name in TOOLS if (version := _version(name)))
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
