"""Work against precision: every tool at five settings, each beside its own results with far tighter ones."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks import case, measure, turns
from benchmarks.race import ARCS, CHECKED, OURS
from benchmarks.turns import Propagation

ROUNDS = 3

LONG = 3.0
"""A flight that takes longer [s] has its slow spells in itself: one round will do."""

WARM_UP = 3600.0
"""Length [s] of the flights before the first round, in which tools compile what a setting needs."""

FINEST = 0.01
"""Where the diagram ends [m]: below it all are equally precise, and so near to it must truths be known."""

INTRODUCTION = """The same arcs, each tool at five settings, from coarse to fine. Own error: the median
distance after 7 days from the tool's own result at the tighter of its tight settings. Times opml: how many
times longer than opml at its cheapest setting with the same own error or less; below 1 cm all count as equal.
"""


@dataclass(frozen=True)
class Point:
    """What a setting costs [ms per arc-day of CPU, median of the rounds], and the own error it leaves [m]."""

    setting: str
    cost: float
    own_error: float


@dataclass(frozen=True)
class Line:
    """A tool at its settings, from coarse to fine.

    arcs: how many it flew; unsettled: distance [m] between its results at its two tight settings.
    """

    about: dict
    arcs: int
    points: list[Point]
    unsettled: float

    @property
    def name(self) -> str:
        """The tool and its method."""
        return f"{self.about['title']}, {self.about['method']}"

    def cheapest(self, error: float) -> Point | None:
        """Return the cheapest of the points with this own error [m] or less, None without one."""
        near = [point for point in self.points if point.own_error <= max(error, FINEST)]
        return min(near, key=lambda point: point.cost, default=None)


Panels = dict[str, dict[str, Line]]
"""The tools' lines by name, under what was flown."""


def run(orekit_data: Path | None, *, progress: Callable[[str], None]) -> tuple[Panels, dict[str, str]]:
    """Return the lines without and with radiation pressure, and why peers did not take part."""
    arcs = case.arcs(ARCS)
    with turns.started(orekit_data) as (workers, absent):
        under_pressure = {name: worker for name, worker in workers.items() if worker.about["pressure"]}
        panels = {
            "without radiation pressure": _lines(workers, arcs.without_pressure(), progress),
            "with radiation pressure": _lines(under_pressure, arcs, progress),
        }
    return panels, absent


def _lines(workers, arcs, progress):
    """Return each tool's line; the flights that are timed are those whose ends are checked."""
    samples = {name: arcs.sample(worker.about["sample"]) for name, worker in workers.items()}
    tight = {name: _tight(worker, samples[name], progress) for name, worker in workers.items()}
    propagations = {
        (name, setting): Propagation(worker, samples[name], setting)
        for name, worker in workers.items()
        for setting in worker.about["settings"]
    }
    progress("warm-up")
    for one in propagations.values():
        replace(one, arcs=one.arcs.lasting(WARM_UP)).fly()
    flown = turns.fly(propagations, rounds=ROUNDS, progress=progress, longest=LONG)
    return {
        name: Line(
            worker.about,
            len(samples[name]),
            [_point(setting, flown[name, setting], tight[name][-1]) for setting in worker.about["settings"]],
            measure.apart(*tight[name]),
        )
        for name, worker in workers.items()
    }


def _tight(worker, arcs, progress):
    """Fly the checked arcs at each of a tool's tight settings; return the states at their ends."""
    progress("{title}, {method}: tight settings".format_map(worker.about))
    checked = arcs.sample(min(CHECKED, len(arcs)))
    return [Propagation(worker, checked, setting).fly().result for setting in worker.about["tight"]]


def _point(setting, flown, truth):
    """Return the point of a flight, compared with the truth of its checked arcs."""
    ends = flown.states[case.spread(len(flown.states), len(truth))]
    return Point(setting, float(np.median(flown.cpu)), measure.apart(ends, truth))


def times_opml(point: Point, ours: Line) -> float:
    """Return how many times longer than opml's cheapest setting that is as precise; 0 where it has none."""
    rival = ours.cheapest(point.own_error)
    return point.cost / rival.cost if rival else 0.0


def leads(panels: Panels) -> dict[str, float]:
    """Return `times_opml` of every setting of every peer, by a text that names it."""
    return {
        f"{line.name}, {point.setting}, {title}": times_opml(point, lines[OURS])
        for title, lines in panels.items()
        for name, line in lines.items()
        for point in line.points
        if name != OURS
    }


def report(panels: Panels, absent: dict[str, str]) -> str:
    """Return the tables of work and precision in Markdown, and whether opml is ahead everywhere."""
    parts = [INTRODUCTION]
    parts += [_table(title, lines) for title, lines in panels.items()]
    parts += [_answer(leads(panels)), _truths(panels)]
    parts += [f"Not run: {name} ({reason}).\n" for name, reason in absent.items()]
    return "\n".join(parts)


def _table(title, lines):
    headings = [
        "tool",
        "setting",
        "arcs",
        "ms per arc-day, CPU",
        "own error [m]",
        "times opml",
        "opml's setting",
    ]
    rows = [_row(line, point, lines[OURS]) for line in lines.values() for point in line.points]
    return f"{title.capitalize()}:\n\n{measure.table(headings, rows)}"


def _row(line, point, ours):
    rival = ours.cheapest(point.own_error) if line is not ours else None
    return [
        line.name,
        point.setting,
        str(line.arcs),
        measure.figures(point.cost),
        measure.figures(point.own_error),
        measure.figures(times_opml(point, ours)) if rival else "-",
        rival.setting if rival else "-",
    ]


def _answer(leads):
    if not leads:
        return "No peer took part.\n"
    behind = [
        f"{name} ({measure.figures(ratio)} times opml)"
        if ratio
        else f"{name} (more precise than any of opml's)"
        for name, ratio in leads.items()
        if ratio <= 1.0
    ]
    if behind:
        return "**opml is not ahead of** " + "; ".join(behind) + ".\n"
    ratios = leads.values()
    return (
        "opml is ahead of every peer at every one of these accuracies: its cheapest setting that is as "
        f"precise takes {measure.figures(min(ratios))} to {measure.figures(max(ratios))} times less.\n"
    )


def _truths(panels):
    """Return how well own errors are known: how far results at a tool's two tight settings are apart."""
    tools = next(iter(panels.values()))
    rows = [
        [
            line.name,
            " and ".join(line.about["tight"]),
            *(_settled(lines[name]) if name in lines else "-" for lines in panels.values()),
        ]
        for name, line in tools.items()
    ]
    text = measure.table(["tool", "tight settings", *(f"apart {title} [m]" for title in panels)], rows)
    return text + f"\nIn bold, what is not below {FINEST:g} m: these own errors are known no better.\n"


def _settled(line):
    text = measure.figures(line.unsettled)
    return text if line.unsettled < FINEST else f"**{text}**"
