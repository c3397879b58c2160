"""Arithmetic of the benchmarks: time per arc-day, paired ratios, distances of states, tables of Markdown."""

from collections.abc import Callable, Sequence
from time import perf_counter

import numpy as np

from opml.orbits.elements import rsw_rotation


def per_arc_day(seconds: float, arc_days: float) -> float:
    """Return the milliseconds for each day of each arc."""
    return 1e3 * seconds / arc_days


def paired_ratio(theirs: Sequence[float], ours: Sequence[float]) -> float:
    """Return the median of their time by ours in the same round, so that slow spells cancel."""
    return float(np.median(np.divide(theirs, ours)))


def best(call: Callable[[], object], *, repeats: int) -> float:
    """Return the shortest of some calls [s]: what disturbs a short one only ever lengthens it."""
    times = []
    for _ in range(repeats):
        begin = perf_counter()
        call()
        times.append(perf_counter() - begin)
    return min(times)


def distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the distance [m] between the positions of states (n, 6)."""
    return np.linalg.norm(a[:, :3] - b[:, :3], axis=1)


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """Return the median distance [m] between the positions of states (n, 6)."""
    return float(np.median(distances(a, b)))


def sigmas(difference: np.ndarray, covariance: np.ndarray) -> float:
    """Return the length of a difference (n,) in units of a formal uncertainty (n, n)."""
    return float(np.sqrt(difference @ np.linalg.solve(covariance, difference)))


def along_track(states: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Return the angles [rad] that states (n, 6) are ahead of others by, about the orbit normal of those."""
    radial, ahead, _ = np.moveaxis(rsw_rotation(reference), 1, 0)
    return np.arctan2(np.sum(states[:, :3] * ahead, axis=1), np.sum(states[:, :3] * radial, axis=1))


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table of Markdown; the first column is text, the others are set flush right."""
    lines = [headings, ["---", *["---:"] * (len(headings) - 1)], *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def figures(value: float, digits: int = 2) -> str:
    """Return a number to some significant digits, in plain notation."""
    if value == 0.0 or not np.isfinite(value):
        return f"{value:.0f}"
    places = max(digits - 1 - int(np.floor(np.log10(abs(value)))), 0)
    return f"{value:.{places}f}"
