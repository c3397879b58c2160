"""Least squares beside the peers': the same tracks, turn by turn, each tool on one core."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks import measure, turns, windows
from benchmarks.fitters import FITTERS
from benchmarks.race import OURS
from benchmarks.windows import Answers, Windows
from benchmarks.worker import Timed, Worker
from opml.catalog.fit.least_squares import Fit

HOURS = (12.0, 48.0)
WINDOWS = 16
ROUNDS = 3

LONG = 5.0
"""A call that takes longer [s] has its slow spells in itself: one round will do."""

BOUNDS = {OURS: 0.001, "orekit": 0.1, "brahe": 30.0}
"""How far a tool's answers may be from opml's [formal sigma], given what their models share.

brahe has another atmosphere, of which Cd takes up the mean alone; two days show the rest.
"""

INTRODUCTION = """State of the paper's RSO at the beginning of a window, fitted to what its three radars
measured in the window. The tracks are flown under opml's assumed model. Every tool begins at the same states,
10 m and 1 cm/s off the truth. Apart: the median distance of its positions from those of opml's fit under what
the two models share, and of its states in opml's formal sigmas.
"""


@dataclass(frozen=True)
class Result:
    """What a tool needed for fits of one length, and how far its answers are from opml's."""

    about: dict
    fits: int
    measurements: float  # in a window, median
    iterations: float  # median
    apart: float  # [m], median
    sigmas: float  # of opml's formal uncertainty, median
    cpu: list[float]  # ms per fit, a round each
    wall: list[float]


Results = dict[tuple[float, str], Result]
"""By length of the windows [h] and tool."""


def run(orekit_data: Path | None, *, progress: Callable[[str], None]) -> tuple[Results, dict[str, str]]:
    """Return the results, and why peers did not take part."""
    with turns.started(orekit_data, FITTERS) as (workers, absent):
        drawn = {
            (hours, name): windows.draw(WINDOWS, hours=hours).sample(worker.about["share"])
            for hours in HOURS
            for name, worker in workers.items()
        }
        _prepare(workers, drawn, progress)
        calls = {key: partial(workers[key[1]].call, "fit", fitted) for key, fitted in drawn.items()}
        taken = turns.take(calls, rounds=ROUNDS, progress=progress, longest=LONG)
        results = {key: _result(workers[key[1]], drawn[key], times) for key, times in taken.items()}
    return results, absent


def _prepare(workers, drawn, progress):
    """Let the tools find out and compile what they need."""
    for (hours, name), fitted in drawn.items():
        progress(f"{workers[name].about['title']}: made ready for windows of {hours:g} hours")
        workers[name].call("prepare", fitted)
        if hours == HOURS[0]:
            workers[name].call("fit", fitted)


def _result(worker: Worker, fitted: Windows, times: list[Timed]) -> Result:
    """Return what the rounds of a tool's fits gave, its answers compared with opml's."""
    found: Answers = times[-1].result
    twins: list[Fit] = worker.call("twin", fitted).result
    off = found.states - np.array([twin.best[:6] for twin in twins])
    sigmas = [measure.sigmas(one, twin.covariance[:6, :6]) for one, twin in zip(off, twins, strict=True)]
    return Result(
        worker.about,
        fits=len(fitted),
        measurements=float(np.median([len(fitted.rows(number)) for number in range(len(fitted))])),
        iterations=float(np.median(found.iterations)),
        apart=float(np.median(np.linalg.norm(off[:, :3], axis=1))),
        sigmas=float(np.median(sigmas)),
        cpu=[1e3 * timed.cpu / len(fitted) for timed in times],
        wall=[1e3 * timed.wall / len(fitted) for timed in times],
    )


def disagreements(results: Results) -> list[str]:
    """Return the fits whose answers are farther from opml's than their models explain."""
    return [
        f"{name}, {hours:g} h"
        for (hours, name), result in results.items()
        if not result.sigmas < BOUNDS[name]
    ]


def report(results: Results, absent: dict[str, str]) -> str:
    """Return the table of the fits and of the models, in Markdown."""
    headings = [
        "tool",
        "window",
        "measurements",
        "fits",
        "iterations",
        "ms per fit, CPU",
        "on the clock",
        "times opml",
        "apart [m]",
        "apart [sigma]",
    ]
    rows = [_row(hours, result, results[hours, OURS]) for (hours, _), result in results.items()]
    tools = {name: result.about for (_, name), result in results.items()}
    models = [
        ["{title}: {model}".format_map(about), "{method}; {way}".format_map(about)]
        for about in tools.values()
    ]
    text = f"{INTRODUCTION}\n{measure.table(headings, rows)}\n"
    text += measure.table(["tool and force model", "fit"], models)
    for name, reason in absent.items():
        text += f"\nNot run: {name} ({reason}).\n"
    for fit in disagreements(results):
        text += f"\n**{fit}: the answers are farther apart than the models explain.**\n"
    return text


def _row(hours, result, ours):
    cost = float(np.median(result.cpu))
    return [
        result.about["title"],
        f"{hours:g} h",
        f"{result.measurements:.0f}",
        str(result.fits),
        f"{result.iterations:g}",
        measure.figures(cost),
        measure.figures(float(np.median(result.wall))),
        measure.figures(cost / float(np.median(ours.cpu))),
        *(["-", "-"] if result is ours else [measure.figures(result.apart), measure.figures(result.sigmas)]),
    ]
