"""How accurate sets of mean elements are by their own past: how far each is from the sets before it.

SGP4 from the newest good set before a set is compared with SGP4 from the set itself, at the points that stand
for it. A set that is many times farther off than usual is left out: its object burned, or it is another's.
Where the next set agrees with it, the object burned, and sets count again. After several in a row that agree
with none, as while an orbit is raised, a new past begins. No set changes how an earlier one is weighed.
"""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.interop import ccsds
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.histories import satellite
from opml.interop.element_sets.sgp4_points import SetSampling
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre, contain_any
from opml.tables import FIX_SIGMAS

GROSS = 10.0  # how many times the usual disagreement a set is off that is left out
USUAL = np.array([100.0, 300.0, 100.0])  # standard deviations of a set in RSW until its object has a past [m]
_FEWEST = 5  # disagreements that make a past, and sets in a row that end it, as they agree with none
_RECENT = 30  # newest disagreements that count

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Past:
    """Disagreements of sets with those before them."""

    gaps: list[float] = field(default_factory=list)  # between the epochs of the two [s]
    distances: list[np.ndarray] = field(default_factory=list)  # root mean squares (3,) in RSW [m]

    def add(self, gap: float, distance: np.ndarray) -> None:
        """Take a disagreement."""
        self.gaps.append(gap)
        self.distances.append(distance)

    @property
    def usual(self) -> np.ndarray | None:
        """The usual distance (3,) in RSW [m]; None without a past."""
        recent = self.distances[-_RECENT:]
        return np.median(recent, axis=0) if len(recent) >= _FEWEST else None

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
        usual = float(np.median(self.gaps[-_RECENT:]))
        growth = max(1.0, (gap + reach) / (usual + reach)) ** 2
        return bool(np.linalg.norm(distance) <= GROSS * growth * np.linalg.norm(self.usual))


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
    known: list[_Set] = []  # the newest set that counts, and those after it
    for row in sets.to_dict("records"):
        one = _Set(float(row["t"]), satellite(row, epoch=epoch))
        if known and contain_any(np.array([known[0].t]), np.array([one.t]), manoeuvres)[0]:
            known = []
        if len(known) == _FEWEST:
            past, known = _Past(), []
        others = [*known[:1], *known[1:][-1:]]
        counts = not known or any(_agree(past, other, one, epoch, sampling) for other in others)
        known = [one] if counts else [*known, one]
        rows.append([counts, *past.sigma])
        if not counts:
            _log.warning("%s disagrees with those before it and is ignored: a burn?", place(row, epoch))
    return pd.DataFrame(rows, columns=["counts", *FIX_SIGMAS[:3]], index=sets.index)


class _Set(NamedTuple):
    """A set, made for SGP4 once."""

    t: float
    satellite: Satrec


def _agree(past: _Past, earlier: _Set, later: _Set, epoch: str, sampling: SetSampling) -> bool:
    """Return whether two sets are as near each other as usual, and take it for the past if they are."""
    t = sampling.times(later.t)
    states, others = (mean_elements.states(one.satellite, epoch=epoch, t=t) for one in (later, earlier))
    distance = np.sqrt(np.mean(in_rsw(others - states, states)[:, :3] ** 2, axis=0))
    gap = later.t - earlier.t
    is_usual = past.is_usual(gap, distance, reach=sampling.reach)
    if is_usual:
        past.add(gap, distance)
    return is_usual


def place(one: Mapping[Any, Any] | pd.Series, epoch: str) -> str:
    """Return where a set is in its file, and of when it is, for a log."""
    (time,) = ccsds.utc_texts(epoch, np.array([one["t"]]))
    return f"{one['file']}: line {one['line']}: the set of {time}"
