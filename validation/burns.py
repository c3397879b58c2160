"""Looks for burns in histories of mean elements, and prints which of those published are found, and how late:

    python -m validation.burns <folder>

The folder holds `burns/<object>.yaml`, each with the times that its operator published, and
`tle/*_<object>.tle.gz`, its sets.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.interop.element_sets import burns_in_sets, known_sets
from opml.orbits import manoeuvres
from opml.orbits.manoeuvres import Manoeuvre

EPOCH = "2010-01-01T00:00:00"
YEAR = 365.25 * DAY

FIRST = 30.0 * DAY
"""Time after the first set from which on burns count [s]: a launch burns daily, and there is no past."""

APART = -1.0 * DAY, 3.0 * DAY
"""How far the time of a burn may lie behind that of the published one that it is [s]."""

CHOSEN_ON = ("CryoSat-2", "Haiyang-2A", "Jason-3", "Sentinel-3A")
"""Objects whose histories the limits of `burns_in_sets` were chosen on; the others judge them."""


@dataclass(frozen=True)
class Judged:
    """How the burns found in a history agree with those published.

    published: how many there are
    late: of each that was found, from the burn to the set that told it [s]
    false: how many were found that nobody published
    years: that the history lasts
    """

    published: int
    late: Sequence[float]
    false: int
    years: float

    def row(self) -> dict[str, float]:
        """Return the numbers that are printed."""
        return {
            "published": self.published,
            "found": len(self.late),
            "found_%": 100.0 * len(self.late) / self.published,
            "days_late": float(np.median(self.late)) / DAY if self.late else np.nan,
            "false_per_year": self.false / self.years,
        }


def judged(found: Sequence[Manoeuvre], published: np.ndarray, span: tuple[float, float]) -> Judged:
    """Return how burns agree with published ones.

    published: (n,) times [s]
    span: first and last time that count [s]
    """
    begin, end = span
    times, known = (np.array([getattr(one, name) for one in found]) for name in ("t", "known"))
    behind = times[:, None] - published
    same = (behind >= APART[0]) & (behind <= APART[1])
    counting = np.flatnonzero((begin <= published) & (published <= end))
    late = [float(known[same[:, k]].min() - published[k]) for k in counting if same[:, k].any()]
    alone = ~same.any(axis=1) & (begin <= times) & (times <= end)
    return Judged(len(counting), late, int(alone.sum()), (end - begin) / YEAR)


def of_object(folder: Path, name: str) -> Judged:
    """Return how the burns found in the history of an object agree with those published."""
    (path,) = (folder / "tle").glob(f"*_{name}.tle.gz")
    sets = known_sets.since(EPOCH, known_sets.of_object([path], None), latency=0.0)
    times = manoeuvres.at_times(manoeuvres.read_times(folder / "burns" / f"{name}.yaml"), epoch=EPOCH)
    span = sets[0].t + FIRST, sets[-1].t
    return judged(burns_in_sets.burns_among(sets, epoch=EPOCH), np.array([one.t for one in times]), span)


def main(folder: Path) -> None:
    """Print a row for each object, those that the limits were chosen on first."""
    names = sorted(path.stem for path in (folder / "burns").glob("*.yaml"))
    for title, chosen in (("chosen on", True), ("judged on", False)):
        objects = {name: of_object(folder, name) for name in names if (name in CHOSEN_ON) == chosen}
        rows = pd.DataFrame([one.row() for one in objects.values()], index=list(objects))
        print(f"\n{title}\n{rows.round(1)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
