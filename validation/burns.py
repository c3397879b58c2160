"""Looks for burns in histories of mean elements, and prints which of those published are found, and how late:

    python -m validation.burns <folder> [BEGIN END WEATHER OBJECT...]

The folder holds `burns/<object>.yaml`, each with the times that its operator published, and
`tle/*_<object>.tle.gz`, its sets. With dates, a CSSI file and objects, the changes that `opml orbit` tells by
the orbits inside their sets stand beside, of that time.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets.inside import orbit_history
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


def of_object(folder: Path, name: str, span: tuple[float, float] | None = None) -> Judged:
    """Return how the burns found in the history of an object agree with those published.

    span: first and last time that count [s]; None: all after FIRST
    """
    sets = known_sets.since(EPOCH, known_sets.of_object([_sets_of(folder, name)], None), latency=0.0)
    whole = sets[0].t + FIRST, sets[-1].t
    return judged(burns_in_sets.burns_among(sets, epoch=EPOCH), _published(folder, name), span or whole)


def by_orbits(folder: Path, name: str, begin: str, end: str, weather: str) -> Judged:
    """Return the same of the burns that the orbits inside its sets tell, between two UTC texts.

    They are known when the next set is: later ones do not make them.
    """
    history = orbit_history.find(_sets_of(folder, name), begin=begin, end=end, weather=weather)
    shift = epochs.seconds_between(EPOCH, history.epoch)
    found = [Manoeuvre(0.5 * (one.begin + one.end) + shift, one.end + shift) for one in history.changes]
    return judged(found, _published(folder, name), _span(begin, end))


def _span(begin: str, end: str) -> tuple[float, float]:
    return epochs.seconds_between(EPOCH, begin), epochs.seconds_between(EPOCH, end)


def _sets_of(folder: Path, name: str) -> Path:
    (path,) = (folder / "tle").glob(f"*_{name}.tle.gz")
    return path


def _published(folder: Path, name: str) -> np.ndarray:
    times = manoeuvres.read_times(folder / "burns" / f"{name}.yaml")
    return np.array([one.t for one in manoeuvres.at_times(times, epoch=EPOCH)])


def main(folder: Path, *asked: str) -> None:
    """Print a row for each object, those that the limits were chosen on first."""
    if asked:
        begin, end, weather, *names = asked
        for name in names:
            by_sets = of_object(folder, name, _span(begin, end))
            both = {"mean elements": by_sets, "orbits inside": by_orbits(folder, name, begin, end, weather)}
            print(f"\n{name}, {begin} to {end}\n{_table(both)}")
        return
    names = sorted(path.stem for path in (folder / "burns").glob("*.yaml"))
    for title, chosen in (("chosen on", True), ("judged on", False)):
        objects = {name: of_object(folder, name) for name in names if (name in CHOSEN_ON) == chosen}
        print(f"\n{title}\n{_table(objects)}")


def _table(judged: Mapping[str, Judged]) -> pd.DataFrame:
    return pd.DataFrame([one.row() for one in judged.values()], index=list(judged)).round(1)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
