"""How accurate sets of mean elements are by their own past: how far each is from the sets before it.

SGP4 from the newest good set before a set is compared with SGP4 from the set itself, at the points that stand
for it. A set that is many times farther off than usual is left out: its object burned, or it is another's.
Where the next set agrees with it, the object burned, and sets count again. After several in a row that agree
with none, as while an orbit is raised, a new past begins. No set changes how an earlier one is weighed.
"""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from opml.interop import ccsds
from opml.interop.element_sets import histories, mean_elements
from opml.orbits.manoeuvres import Manoeuvre, contain_any
from opml.tables import FIX_SIGMAS

GROSS = 10.0  # how many times the usual disagreement a set is off that is left out
USUAL = np.array([100.0, 300.0, 100.0])  # standard deviations of a set in RSW until its object has a past [m]
_FEWEST = 5  # disagreements that make a past, and sets in a row that end it, as they agree with none
_RECENT = 30  # newest disagreements that count

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class SetSampling:
    """Which points stand for a set of mean elements."""

    reach: float  # from the first point to the last [s]
    step: float  # between points [s]

    def times(self, end: float) -> np.ndarray:
        """Return the times (n,) of the points of a set up to its last one, `end` [s]."""
        return end - self.step * np.arange(round(self.reach / self.step), -1, -1)


@dataclass
class _Past:
    """Disagreements of sets with those before them."""

    gaps: list[float] = field(default_factory=list)  # between the epochs of the two [s]
    distances: list[np.ndarray] = field(default_factory=list)  # root mean squares (3,) in RSW [m]
    usual: np.ndarray | None = None  # the usual distance (3,), None without a past

    def add(self, gap: float, distance: np.ndarray) -> None:
        """Take a disagreement."""
        self.gaps.append(gap)
        self.distances.append(distance)
        if len(self.distances) >= _FEWEST:
            self.usual = _median(self.distances[-_RECENT:])

    @property
    def sigma(self) -> np.ndarray:
        """Standard deviation (3,) of a set in RSW [m]: two sets make a distance."""
        return USUAL if self.usual is None else self.usual / np.sqrt(2.0)

    def is_usual(self, gap: float, distance: np.ndarray, *, reach: float) -> bool:
        """Return whether a disagreement is a usual one; all are without a past.

        It may grow with the square of the time to the farthest point, as what drag does.

        reach: of the points that it was taken at [s]
        """
        if self.usual is None:
            return bool(np.isfinite(distance).all())
        usual = float(_median(self.gaps[-_RECENT:]))
        growth = max(1.0, (gap + reach) / (usual + reach)) ** 2
        return bool(np.linalg.norm(distance) <= GROSS * growth * np.linalg.norm(self.usual))


def _median(values: Sequence[Any]) -> np.ndarray:
    """Return the median of finite values or rows, as `np.median`, which takes longer to begin."""
    ranked, count = np.sort(values, axis=0), len(values)
    return np.asarray(0.5 * (ranked[(count - 1) // 2] + ranked[count // 2]))


def weighed(
    sets: pd.DataFrame, *, epoch: str, sampling: SetSampling, manoeuvres: Sequence[Manoeuvre] = ()
) -> pd.DataFrame:
    """Return how accurate each set of one object is: whether it `counts`, and its sigmas in RSW [m].

    sets: table `element_sets` of one object
    sampling: of the points that stand for a set
    manoeuvres: across which no sets are compared with each other, once known

    Sets that do not count are logged.
    """
    past, rows = _Past(), []
    known: list[int] = []  # the newest set that counts, and those after it
    t, distances = sets["t"].to_numpy(), _Distances(sets, epoch, sampling)
    for k in range(len(sets)):
        if known and contain_any(t[known[:1]], t[k : k + 1], manoeuvres)[0]:
            known = []
        if len(known) == _FEWEST:
            past, known = _Past(), []
        others = [*known[:1], *known[1:][-1:]]
        counts = not known or any(_agree(past, distances, other, k) for other in others)
        known = [k] if counts else [*known, k]
        rows.append([counts, *past.sigma])
        if not counts:
            set_place = place(sets.iloc[k], epoch)
            _log.warning("%s disagrees with those before it and is ignored: a burn?", set_place)
    return pd.DataFrame(rows, columns=["counts", *FIX_SIGMAS[:3]], index=sets.index)


class _Distances:
    """How far sets of one object are from each other."""

    def __init__(self, sets: pd.DataFrame, epoch: str, sampling: SetSampling) -> None:
        self.t, self._epoch, self.sampling = sets["t"].to_numpy(), epoch, sampling
        self._satellites = histories.satellites(sets, epoch=epoch)
        later = np.arange(1, len(sets))
        self._successive = self._between(later - 1, later) if len(later) else np.empty((0, 3))

    def distance(self, earlier: int, later: int) -> np.ndarray:
        """Return the root mean square distance (3,) of two sets at the points of the later one in RSW [m]."""
        if later == earlier + 1:
            return self._successive[earlier]
        return self._between(np.array([earlier]), np.array([later]))[0]

    def _between(self, earlier: np.ndarray, later: np.ndarray) -> np.ndarray:
        t = np.array([self.sampling.times(end) for end in self.t[later]])
        pairs = ([self._satellites[k] for k in rows] for rows in (earlier, later))
        off = mean_elements.differences(*pairs, epoch=self._epoch, t=t)[..., :3]
        return np.asarray(np.sqrt(np.mean(off**2, axis=1)))


def _agree(past: _Past, distances: _Distances, earlier: int, later: int) -> bool:
    """Return whether two sets are as near each other as usual, and take it for the past if they are."""
    gap, distance = float(distances.t[later] - distances.t[earlier]), distances.distance(earlier, later)
    is_usual = past.is_usual(gap, distance, reach=distances.sampling.reach)
    if is_usual:
        past.add(gap, distance)
    return is_usual


def place(one: Mapping[Any, Any] | pd.Series, epoch: str) -> str:
    """Return where a set is in its file, and of when it is, for a log."""
    (time,) = ccsds.utc_texts(epoch, np.array([one["t"]]))
    return f"{one['file']}: line {one['line']}: the set of {time}"
