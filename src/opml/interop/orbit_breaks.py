"""Where an orbit breaks: a seam between two solutions, a manoeuvre, a node that is wrong.

Between two nodes the Earth's gravity says how the velocity changes (opml.interop.bridging). At a node, what
comes from the left and what goes to the right differ by little: by what else pulls, times the length of an
interval, and by the noise of the positions, divided by it. A node where they differ by far more marks a
break. A change of velocity makes one jump, or several in the same direction; a step s of the position makes
two opposite ones, s / T each, at the ends of its interval of length T; a wrong node makes three that cancel.
Where many jump to and fro, the orbit has become noisy, and does not break.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import HOUR

LEAST_JUMP = 5e-4
"""Smallest jump of the velocity that counts [m/s]; in a day it moves a low orbit by 130 m along its track."""

TIMES_USUAL = 10.0
"""By how much a jump has to exceed what is usual in USUAL_HOURS before it, or in as many after it."""

USUAL_HOURS = 12
_MOST_NODES = 4  # of a break that is no manoeuvre: two wrong nodes jump at four
_MOST_NOISE = 30.0  # swing of it [m]; larger ones are nodes that are wrong, side by side
_OF_SWING = 0.2  # part of it that is a step; after wrong nodes less than a hundredth stays
_UNLIKE = 30.0  # ratio of jumps side by side that have nothing to do with each other
_FEWEST_HOURS = 3  # with nodes, for a side to count

LEAST_SEAM = 0.05
"""Smallest step between two solutions that is told [m], the accuracy of precise orbits."""

BRIDGED = 0.05
"""How wrong an interval at a break may become when it is bridged nevertheless [m]."""


@dataclass(frozen=True)
class Break:
    """Jumps that belong together, at the nodes `first` to `last`."""

    first: int
    last: int
    t: float  # [s]
    velocity: float  # change of velocity, all jumps together [m/s]
    step: float  # of the position at t [m]
    swing: float  # position that the largest jump alone tells of [m]
    one_way: bool  # whether the jumps add up, as those of a manoeuvre do

    @property
    def is_noise(self) -> bool:
        """Whether there are small jumps up and down, more than two solutions or a few wrong nodes make."""
        return not self.one_way and self.last - self.first >= _MOST_NODES and self.swing < _MOST_NOISE

    @property
    def is_seam(self) -> bool:
        """Whether the orbit goes on elsewhere than it came from."""
        return not self.one_way and self.step >= max(LEAST_SEAM, _OF_SWING * self.swing)


def find(t: np.ndarray, jumps: np.ndarray) -> tuple[list[Break], np.ndarray, np.ndarray]:
    """Breaks of an orbit with nodes at t (n,) [s], where its velocity jumps by `jumps` (n, 3) [m/s].

    Returns them, the nodes that jump (n,), and the intervals (n - 1,) that cannot be bridged because of them.
    """
    size = np.linalg.norm(jumps, axis=1)
    large = size > np.maximum(LEAST_JUMP, TIMES_USUAL * _usual(t, size))
    breaks = [one for one in (_break(t, jumps, nodes) for nodes in _groups(size, large)) if not one.is_noise]
    jumping, broken = np.zeros(len(t), bool), np.zeros(len(t) - 1, bool)
    for one in breaks:
        jumping[one.first : one.last + 1] = large[one.first : one.last + 1]
        first, last = _with_ends(size, one)
        worse = np.maximum(size[first:last], size[first + 1 : last + 1])
        broken[first:last] = worse * np.diff(t[first : last + 1]) / 4.0 > BRIDGED
    return breaks, jumping, broken


def _usual(t: np.ndarray, size: np.ndarray) -> np.ndarray:
    """The usual size (n,) [m/s] of a jump at each node: of the median acceleration behind those around it.

    Medians by the hour first, so that the close nodes about a manoeuvre do not outvote half a day.
    """
    width = np.gradient(t)
    hour = np.floor(t / HOUR).astype(int)
    hourly = pd.Series(np.where(size > 0.0, size / width, np.nan)).groupby(hour).median()
    hourly = hourly.reindex(range(hour[0], hour[-1] + 1))
    before = hourly.rolling(USUAL_HOURS, min_periods=_FEWEST_HOURS).median()
    after = hourly[::-1].rolling(USUAL_HOURS, min_periods=_FEWEST_HOURS).median()[::-1]
    smaller = np.fmin(before, after).fillna(hourly.median())
    usual: np.ndarray = np.nan_to_num(smaller.reindex(hour).to_numpy()) * width
    return usual


def _groups(size: np.ndarray, large: np.ndarray) -> Iterator[np.ndarray]:
    """Nodes with a large jump, group by group: up to one quiet node lies between those of a group."""
    nodes = np.flatnonzero(large)
    if nodes.size:
        ratio = np.abs(np.diff(np.log(size[nodes])))
        yield from np.split(nodes, np.flatnonzero((np.diff(nodes) > 2) | (ratio > np.log(_UNLIKE))) + 1)


def _break(t: np.ndarray, jumps: np.ndarray, nodes: np.ndarray) -> Break:
    middle = (t[nodes[0]] + t[nodes[-1]]) / 2.0
    own = jumps[nodes]
    size, change = np.linalg.norm(own, axis=1), float(np.linalg.norm(own.sum(axis=0)))
    return Break(
        first=int(nodes[0]),
        last=int(nodes[-1]),
        t=float(middle),
        velocity=float(size.sum()),
        step=float(np.linalg.norm((middle - t[nodes]) @ own)),
        swing=float((size * np.minimum(t[nodes] - t[nodes - 1], t[nodes + 1] - t[nodes])).max()),
        one_way=bool(change > 0.5 * size.sum()),
    )


def _with_ends(size: np.ndarray, one: Break) -> tuple[int, int]:
    """First and last node of a break; an end of the orbit beside it, where no jump shows, belongs to it."""
    return one.first - (size[one.first - 1] == 0.0), one.last + (size[one.last + 1] == 0.0)
