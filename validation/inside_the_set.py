"""Holds predictions from public element sets against a precise orbit of the object:

    python -m validation.inside_the_set ORBIT SETS...

ORBIT is an SP3, CPF or OEM file, SETS are files of the object's element sets. On each morning of the orbit,
06 UTC, the object is predicted by the sets and the weather known then. A line a lead tells the root mean
square over the mornings, outwards, along and across the track [m], of SGP4 from the newest set and of `opml
predict`, each over two hundred minutes, and how many of the errors are inside nine in ten by the covariance.
"""

import sys
from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets import prediction
from opml.interop import known_orbits
from opml.interop.element_sets import mean_elements
from opml.interop.ephemeris import EPOCH
from opml.interop.predicted_orbit import LEADS
from opml.orbits.elements import bent_rsw
from opml.orbits.rsw_covariance import half_width

_AROUND = 60.0 * np.arange(-100.0, 101.0, 5.0)
_AXES = ("r", "s", "w")
_LEVEL = 0.9


def errors(orbit: known_orbits.KnownOrbit, sets: Sequence[str]) -> pd.DataFrame:
    """Return the errors: lead, morning, r, s, w [m] of the prediction, and the same of SGP4 and of a
    sigma.
    """
    first, last = (epochs.calendar(_day(orbit.t[k])) for k in (0, -1))
    dates = pd.date_range(first, last, freq="D").strftime("%Y-%m-%dT06:00:00")
    return pd.DataFrame([row for date in dates for row in _of_morning(orbit, sets, date)])


def _day(t: float) -> float:
    return float(np.sum(epochs.utc(EPOCH, t)) - epochs.MJD_ZERO)


def _of_morning(
    orbit: known_orbits.KnownOrbit, sets: Sequence[str], date: str
) -> Iterator[dict[str, object]]:
    now = epochs.seconds_between(EPOCH, date)
    predicted = prediction.predict(sets, date=date)
    for lead in LEADS:
        t = DAY * lead + _AROUND
        t = t[(t >= 0.0) & (t <= DAY * predicted.days)]
        truth = orbit.at(now + t)
        there = np.isfinite(truth).all(axis=1)
        if not there.any():
            continue
        t, truth = t[there], truth[there]
        flown = {
            "": predicted.states(t),
            "sgp4_": mean_elements.states(predicted.published, epoch=date, t=t),
        }
        off = {name: bent_rsw(states[:, :3], truth) for name, states in flown.items()}
        sizes = {name: np.sqrt((one**2).mean(axis=0)) for name, one in off.items()}
        inside = np.abs(off[""]) <= half_width(_LEVEL) * predicted.sigmas(t)
        yield {"lead": lead, "morning": date, "is_inside": not isinstance(predicted.inside, str)} | {
            f"{name}{axis}": value
            for name, values in [*sizes.items(), ("share_", inside.mean(axis=0))]
            for axis, value in zip(_AXES, values, strict=True)
        }


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return by lead the mornings, root mean squares, and the percentage inside nine in ten."""
    names = [f"{name}{axis}" for name in ("sgp4_", "") for axis in _AXES]
    squares = (rows[names] ** 2).groupby(rows["lead"]).mean() ** 0.5
    shares = 100.0 * rows.groupby("lead")[[f"share_{axis}" for axis in _AXES]].mean()
    return pd.concat([rows.groupby("lead").size().rename("mornings"), squares, shares], axis=1).round()


def main(arguments: Sequence[str]) -> None:
    """Print the table of an orbit and sets."""
    orbit = known_orbits.read(arguments[:1])
    rows = errors(orbit, arguments[1:])
    print(table(rows).astype(int).to_string())
    print(rows.groupby("morning")["is_inside"].first().to_string())


if __name__ == "__main__":
    main(sys.argv[1:])
