"""Holds later sets, the judges of a catalogue, against a precise orbit of one object:

    python -m validation.later_sets ORBIT NUMBER SETS...

ORBIT is an SP3 file, NUMBER that of the object in the catalogue, SETS are files of element sets, of others,
too. On each morning of the orbit the object's newest set, as published and as improved, is flown to the later
set that judges it; the table tells median errors along the track, by that set and by the orbit.
"""

import sys
from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets import catalogue, density, improve, set_errors, trained_model
from opml.element_sets.catalogue import ElementCatalogue, modified_julian_day
from opml.element_sets.training import HOUR_OF_MORNING
from opml.environment import known_weather
from opml.environment.solar_activity import OBSERVED
from opml.interop import known_orbits
from opml.interop.curves.orbit_path import EPOCH
from opml.interop.element_sets import teme
from opml.interop.element_sets.element_set import changed, propagate, seconds_since

_WEATHER = density.clean(known_weather.read(OBSERVED))
_REACH = 60.0
"""Days of sets before a morning that it is given."""


def errors(orbit: known_orbits.KnownOrbit, number: int, sets: ElementCatalogue) -> pd.DataFrame:
    """Return what an object's sets are off by [m]: lead, and each set by the orbit and by the later set."""
    first, last = (modified_julian_day(EPOCH) + orbit.t[k] / DAY for k in (0, -1))
    mornings = np.arange(np.ceil(first), last) + HOUR_OF_MORNING
    return pd.DataFrame([row for one in mornings for row in _of_morning(orbit, number, sets, float(one))])


def _of_morning(
    orbit: known_orbits.KnownOrbit, number: int, sets: ElementCatalogue, morning: float
) -> Iterator[dict[str, float]]:
    near = sets.take(np.flatnonzero(sets.table["t"].between(morning - _REACH, morning + _REACH)))
    known = near.until(morning).daily()
    public = improve.PublicData(known, _WEATHER.keep_known(morning), f"{epochs.calendar(morning)}T06:00:00")
    made = improve.improve(public, trained_model.read()).table.set_index("number").loc[number]
    old = known.satellites[np.flatnonzero(known.table["number"] == number)[-1]]
    flown = {"sgp4": old, "improved": changed(old, made["motion"], made["bstar"])}
    own = near.daily().take(np.flatnonzero(near.daily().table["number"] == number))
    for lead in set_errors.LEADS:
        away = (own.table["t"] - morning - lead).abs()
        judge = own.satellites[int(away.argmin())]
        truth = orbit.at(seconds_since(EPOCH, [judge]))
        if away.min() <= set_errors.REACH and np.isfinite(truth).all():
            yield {"lead": lead, **_off(flown, judge, truth)}


def _off(flown: dict[str, Satrec], judge: Satrec, truth: np.ndarray) -> dict[str, float]:
    """Return errors along the track [m] at the epoch of a later set, by that and by the true state (1, 6)."""
    at = seconds_since(EPOCH, [judge])
    to_gcrf = teme.teme_to_gcrf(EPOCH, at)[0]
    position, velocity = propagate(judge, np.zeros(1))
    found = {}
    for name, one in flown.items():
        place, _ = propagate(one, (at - seconds_since(EPOCH, [one])) / 60.0)
        found[f"{name} by the set"] = float(set_errors.along_track(place, position, velocity)[0])
        true = 1e-3 * truth
        found[f"{name} by the orbit"] = float(
            set_errors.along_track(place @ to_gcrf.T, true[:, :3], true[:, 3:])[0]
        )
    return found


def main(arguments: Sequence[str]) -> None:
    """Print the medians of an orbit's file, a number and files of sets."""
    orbit, number, *files = arguments
    found = errors(known_orbits.read([orbit]), int(number), catalogue.read(files)).abs()
    print(found.groupby("lead").median().join(found.groupby("lead").size().rename("n")).round().to_string())


if __name__ == "__main__":
    main(sys.argv[1:])
