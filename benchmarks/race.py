"""opml beside the peers: the same arcs, turn by turn, each tool on one core."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks import case, measure, turns
from benchmarks.turns import Propagation

ARCS = 100
ROUNDS = 5
CHECKED = 8
"""Arcs on which answers are compared."""

OURS = "opml"


@dataclass
class Result:
    """What one tool needed, and how far its answers are from where they should be."""

    about: dict
    arcs: int
    cpu: list[float] = field(default_factory=list)  # ms per arc-day, a round each
    wall: list[float] = field(default_factory=list)
    own_error: float = np.nan  # [m] from its own result with settings far tighter
    vacuum: float = np.nan  # [m] from opml's without drag
    drag: float = np.nan  # along-track effect of drag over that in opml
    apart: float = np.nan  # [m] from opml's with drag


@dataclass(frozen=True)
class Bound:
    """How far a tool's answers may be from opml's after seven days, given what their models share."""

    vacuum: float  # [m]
    drag: float  # part of the effect of drag

    def holds(self, result: Result) -> bool:
        """Return whether the answers agree that far."""
        return result.vacuum < self.vacuum and abs(result.drag - 1.0) < self.drag


NETWORK_OR_MSIS = Bound(vacuum=500.0, drag=0.15)
SAME_MODELS = Bound(vacuum=200.0, drag=0.001)
BOUNDS = {
    OURS: SAME_MODELS,
    "satkit_gauss_jackson": NETWORK_OR_MSIS,
    "satkit": NETWORK_OR_MSIS,
    "heyoka": NETWORK_OR_MSIS,
    "orekit": SAME_MODELS,
}


def run(
    orekit_data: Path | None, *, rounds: int, progress: Callable[[str], None]
) -> tuple[dict[str, Result], dict[str, str]]:
    """Return the results by peer, and why peers did not take part."""
    arcs = case.arcs(ARCS)
    with turns.started(orekit_data) as (workers, absent):
        results = {}
        for name, worker in workers.items():
            progress(f"{worker.about['title']}: answers")
            results[name] = _answers(worker, arcs)
        propagations = {
            name: Propagation(worker, arcs.sample(results[name].arcs), worker.about["raced"])
            for name, worker in workers.items()
        }
        for name, flown in turns.fly(propagations, rounds=rounds, progress=progress).items():
            results[name].cpu, results[name].wall = flown.cpu, flown.wall
    return results, absent


def _answers(worker, arcs):
    """Hold a tool's answers against its own tight ones and against opml's; this also warms it up."""
    count = min(worker.about["share"], ARCS)
    sample = arcs.sample(min(CHECKED, count))
    vacuum = sample.without_drag()
    found, found_vacuum, tight = (
        Propagation(worker, flown, setting).fly().result
        for flown, setting in [
            (sample, worker.about["raced"]),
            (vacuum, worker.about["raced"]),
            (sample, worker.about["tight"][-1]),
        ]
    )
    twin, twin_vacuum = worker.call("twin", sample).result, worker.call("twin", vacuum).result
    effect, twin_effect = measure.along_track(found, found_vacuum), measure.along_track(twin, twin_vacuum)
    return Result(
        about=worker.about,
        arcs=count,
        own_error=measure.apart(found, tight),
        vacuum=measure.apart(found_vacuum, twin_vacuum),
        drag=float(np.median(effect / twin_effect)),
        apart=measure.apart(found, twin),
    )


def disagreements(results: dict[str, Result]) -> list[str]:
    """Return the tools whose answers are farther from opml's than their models explain."""
    return [name for name, result in results.items() if not BOUNDS[name].holds(result)]


def report(results: dict[str, Result], absent: dict[str, str]) -> str:
    """Return the tables of speed and of answers, in Markdown."""
    ours = results[OURS].cpu
    speed = [
        [
            "{title}: {method}, {raced}; {way}".format_map(result.about),
            str(result.arcs),
            measure.figures(float(np.median(result.cpu))),
            measure.figures(float(np.median(result.wall))),
            measure.figures(measure.paired_ratio(result.cpu, ours)),
            measure.figures(result.own_error),
        ]
        for result in results.values()
    ]
    answers = [
        [
            f"{result.about['title']}: {result.about['model']}",
            measure.figures(result.vacuum),
            f"{result.drag:.4f}",
            measure.figures(result.apart),
        ]
        for name, result in results.items()
        if name != OURS
    ]
    headings = ["tool", "arcs", "ms per arc-day, CPU", "on the clock", "times opml", "own error [m]"]
    agreement = ["tool and force model", "apart without drag [m]", "effect of drag over opml's", "apart [m]"]
    text = measure.table(headings, speed) + "\n" + measure.table(agreement, answers)
    for name, reason in absent.items():
        text += f"\nNot run: {name} ({reason}).\n"
    for name in disagreements(results):
        text += f"\n**{name} disagrees by more than its models explain.**\n"
    return text
