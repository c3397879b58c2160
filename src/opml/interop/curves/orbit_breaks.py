"""Detection of breaks in an orbit: seams between two solutions, manoeuvres and wrong nodes.

Each interval between two nodes has a velocity at both ends, by the Earth's gravity (gravity_interpolation).
At a node the velocities of the two intervals differ little: by the other forces times the length of an
interval, and by the noise of the positions divided by this length. A much larger difference, a jump, marks a
break. A manoeuvre makes one jump, or several in the same direction. A step s of the position makes two
opposite jumps of s / T at the ends of its interval of length T. A wrong node makes three jumps that cancel.
Many jumps to and fro are noise, not a break.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import HOUR

LEAST_JUMP = 5e-4
"""Smallest jump of the velocity that counts [m/s]; in a day it moves a low orbit by 130 m along its track."""

TIMES_USUAL = 10.0
"""Least ratio of a jump to the usual jump in USUAL_HOURS before it or after it, whichever is smaller."""

USUAL_HOURS = 12  # hours before and after a jump whose jumps are its usual ones
_MOST_NODES = 4  # of a break other than a manoeuvre: two wrong nodes make four jumps
_MOST_NOISE = 30.0  # largest swing of noise [m]; a larger swing comes from adjacent wrong nodes
_OF_SWING = 0.2  # least ratio of a seam's step to its swing; wrong nodes leave less than a hundredth
_UNLIKE = 30.0  # ratio of adjacent jumps of different causes
_FEWEST_HOURS = 3  # with nodes, for a side to count
LEAST_SEAM = 0.05  # smallest step between two solutions that is reported [m], the accuracy of precise orbits
BRIDGED = 0.05  # largest error of an interval at a break that is bridged nevertheless [m]


@dataclass(frozen=True)
class Break:
    """A group of jumps with one cause, at the nodes `first` to `last`."""

    first: int
    last: int
    t: float  # middle of the group [s]
    velocity: float  # sum of the sizes of the jumps [m/s]
    step: float  # of the position at t [m]
    swing: float  # shift of the position that the largest jump alone would mean [m]
    one_way: bool  # whether the jumps add up, as in a manoeuvre

    @property
    def is_noise(self) -> bool:
        """Whether the jumps are small, opposite, and too many for two solutions or a few wrong nodes."""
        return not self.one_way and self.last - self.first >= _MOST_NODES and self.swing < _MOST_NOISE

    @property
    def is_seam(self) -> bool:
        """Whether the position after the break differs from that before it."""
        return not self.one_way and self.step >= max(LEAST_SEAM, _OF_SWING * self.swing)


def find(t: np.ndarray, jumps: np.ndarray) -> tuple[list[Break], np.ndarray, np.ndarray]:
    """Return the breaks of an orbit, which nodes (n,) jump, and which intervals (n - 1,) to leave open.

    t: (n,) times of the nodes [s]
    jumps: (n, 3) of the velocity at the nodes [m/s]
    """
    size = np.linalg.norm(jumps, axis=1)
    large = size > np.maximum(LEAST_JUMP, TIMES_USUAL * _usual_size(t, size))
    groups = [_break(t, jumps, nodes) for nodes in _groups(size, large)]
    breaks = [group for group in groups if not group.is_noise]
    jumping, broken = np.zeros(len(t), bool), np.zeros(len(t) - 1, bool)
    for event in breaks:
        jumping[event.first : event.last + 1] = large[event.first : event.last + 1]
        # An adjacent end of the orbit, which has no jump, belongs to the break.
        first = event.first - (size[event.first - 1] == 0.0)
        last = event.last + (size[event.last + 1] == 0.0)
        worse = np.maximum(size[first:last], size[first + 1 : last + 1])
        broken[first:last] = worse * np.diff(t[first : last + 1]) / 4.0 > BRIDGED
    return breaks, jumping, broken


def _usual_size(t: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Return the usual size (n,) [m/s] of a jump at each node, by the median acceleration around it.

    The median is that of hourly medians, so that the close nodes at a manoeuvre do not outvote half a day.
    """
    width = np.gradient(t)
    hour = np.floor(t / HOUR).astype(int)
    hourly = pd.Series(np.where(size > 0.0, size / width, np.nan)).groupby(hour).median()
    hourly = hourly.reindex(range(hour[0], hour[-1] + 1))
    before = hourly.rolling(USUAL_HOURS, min_periods=_FEWEST_HOURS).median()
    after = hourly[::-1].rolling(USUAL_HOURS, min_periods=_FEWEST_HOURS).median()[::-1]
    smaller = np.fmin(before, after).fillna(hourly.median())
    return np.asarray(np.nan_to_num(smaller.reindex(hour).to_numpy()) * width)


def _groups(size: np.ndarray, large: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the nodes with a large jump, group by group; a group has at most one quiet node in a row."""
    nodes = np.flatnonzero(large)
    if nodes.size:
        ratio = np.abs(np.diff(np.log(size[nodes])))
        yield from np.split(nodes, np.flatnonzero((np.diff(nodes) > 2) | (ratio > np.log(_UNLIKE))) + 1)


def _break(t: np.ndarray, jumps: np.ndarray, nodes: np.ndarray) -> Break:
    middle = (t[nodes[0]] + t[nodes[-1]]) / 2.0
    group = jumps[nodes]
    size, change = np.linalg.norm(group, axis=1), float(np.linalg.norm(group.sum(axis=0)))
    return Break(
        first=int(nodes[0]),
        last=int(nodes[-1]),
        t=float(middle),
        velocity=float(size.sum()),
        step=float(np.linalg.norm((middle - t[nodes]) @ group)),
        swing=float((size * np.minimum(t[nodes] - t[nodes - 1], t[nodes + 1] - t[nodes])).max()),
        one_way=bool(change > 0.5 * size.sum()),
    )
