"""Prints what changes for who watches one object for weeks, with public sets, usual errors and opml:

    python -m validation.watch NUMBER FIRST_DAY WEEKS SW-All.csv SETS...

Every seventh morning all objects in SETS, with what was known then, are screened for seven days; those that
come near by SGP4 are predicted by `opml predict`, and screened again. An alarm is a probability from 1e-4 on,
for a radius of 20 m; without a covariance an approach below a kilometre is all there is.
"""

import resource
import sys
import tempfile
import time
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from sgp4.exporter import export_tle

import opml
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.conjunctions import screening
from opml.conjunctions.conjunction import Conjunction
from opml.interop.element_sets.element_set import ElementSet, elements_epoch
from opml.interop.element_sets.known_sets import LATENCY
from opml.interop.element_sets.mean_elements import read_sets
from opml.interop.ephemeris import EPOCH

DAYS, OLDEST = 7.0, 10
"""How long a screening is, and the age of a set beyond which it is of the past [d]."""

LEADS = (1.0, DAYS)
"""Days in which approaches are counted."""

WITHIN, NEAR, RADIUS, THRESHOLD = 10e3, 1e3, 20.0, 1e-4

History = dict[int, list[ElementSet]]


def epoch(one: ElementSet) -> np.datetime64:
    """Return the epoch of a set, UTC."""
    return np.datetime64(elements_epoch(one.satellite), "us")


def known(sets: Sequence[ElementSet], date: np.datetime64) -> History:
    """Return the sets of each object that were known at a date, those of living objects alone.

    sets: in the order of their epochs
    """
    latest, found = date - np.timedelta64(round(DAY * LATENCY), "s"), History()
    for one in sets[: bisect_right(sets, latest, key=epoch)]:
        found.setdefault(one.number, []).append(one)
    oldest = date - np.timedelta64(OLDEST, "D")
    return {number: past for number, past in found.items() if epoch(past[-1]) >= oldest}


def write(path: Path, sets: Iterable[ElementSet]) -> Path:
    """Write sets as TLE."""
    path.write_text("".join("\n".join(export_tle(one.satellite)) + "\n" for one in sets))
    return path


def by_sets(folder: Path, past: History, ours: int, date: np.datetime64) -> list[Conjunction]:
    """Return the approaches of the newest sets by SGP4, with the usual covariances."""
    first = write(folder / "ours.tle", past[ours][-1:])
    others = write(folder / "others.tle", (sets[-1] for k, sets in past.items() if k != ours))
    age = (date - epoch(past[ours][-1])) / np.timedelta64(1, "D")
    read = screening.read([first, others], days=DAYS + age)
    return screening.screen(read, within=WITHIN, radius=RADIUS)


def by_predictions(
    folder: Path, past: History, numbers: Sequence[int], date: str, weather: str
) -> list[Conjunction]:
    """Return the approaches of the first object and the others, each by `opml predict`."""
    files = []
    for number in numbers:
        sets = write(folder / f"{number}.tle", past[number])
        files.append(folder / f"{number}.oem")
        opml.predict(sets, date=date, days=DAYS, weather=weather).to_oem(files[-1])
    return screening.screen(screening.read(files), within=WITHIN, radius=RADIUS) if files[1:] else []


def counts(found: Sequence[Conjunction], case: str) -> dict[str, object]:
    """Return how many approaches there are, and how many raise an alarm."""
    near = [np.linalg.norm(one.relative[:3]) < NEAR for one in found]
    told = [
        [one.chance.probability if one and one.chance else 0.0 for one in (each, each.correlated)]
        for each in found
    ]
    alone, together = np.sum(np.reshape(told, (-1, 2)) >= THRESHOLD, axis=0)
    most = np.max(np.reshape(told, (-1, 2)), axis=0, initial=0.0)
    return {
        "case": case,
        "within_10_km": len(found),
        "within_1_km": sum(near),
        "alarms": alone,
        "alarms_correlated": together,
        "largest": most[0],
    }


def table(ours: int, first: str, weeks: int, weather: str, paths: Sequence[str]) -> pd.DataFrame:
    """Return the counts of every week, lead and case."""
    sets = sorted((one for path in paths for one in read_sets(path, [])), key=epoch)
    rows = []
    for k in range(weeks):
        date = np.datetime64(f"{first}T06:00:00") + np.timedelta64(7 * k, "D")
        begin, past = (date - np.datetime64(EPOCH)) / np.timedelta64(1, "s"), known(sets, date)
        with tempfile.TemporaryDirectory() as folder:
            found = by_sets(Path(folder), past, ours, date)
            flown = [one for one in found if 0.0 <= one.t - begin < DAY * DAYS]
            near = sorted({int(one.second.identity.number) for one in flown})
            predicted = by_predictions(Path(folder), past, [ours, *near], str(date), weather)
        for case, found in (("public sets, usual covariances", flown), ("opml", predicted)):
            for lead in LEADS:
                early = [one for one in found if one.t - begin < DAY * lead]
                rows.append({"days": lead, **counts(early, case)})
    return pd.DataFrame(rows)


def main(number: str, first: str, weeks: str, weather: str, *paths: str) -> None:
    """Print the sums over all weeks, the time and the memory."""
    begun = time.process_time()
    found = table(int(number), first, int(weeks), weather, paths)
    total = found.groupby(["days", "case"], sort=False)
    numbers = ["within_10_km", "within_1_km", "alarms", "alarms_correlated"]
    sums = total[numbers].sum().assign(largest=total["largest"].max(), screenings=total.size())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(sums.to_string(), f"\n{time.process_time() - begun:.0f} s, {memory:.1f} GB", sep="\n")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except InputError as reason:
        sys.exit(f"opml: {reason}")
