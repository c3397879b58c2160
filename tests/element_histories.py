"""Histories of mean elements that agree with each other, but for noise and what a test adds."""

import numpy as np
import pandas as pd
from support import EPOCH

from opml.base.constants import DAY
from opml.interop import ccsds
from opml.interop.element_sets import element_set, tle

ELEMENTS = ["mean_motion", "eccentricity", "inclination", "raan", "argp", "mean_anomaly", "bstar"]

FIRST = [0.0676 / 60.0, 0.0006, *np.radians([51.64, 80.0, 250.0, 100.0])]
"""Elements of an ISS at the epoch; its drag is none."""


def satellite(row):
    """The satellite of a row of `history`."""
    motion, *others = [float(row[name]) for name in ELEMENTS]
    return element_set.satellite(ccsds.utc_texts(EPOCH, [row["t"]])[0], [60.0 * motion, *others])


def history(days, *, noise=0.0, ahead=None, bstar=0.0, created=None):
    """A table of sets at days since the epoch, of an orbit without drag.

    noise: standard deviation of the sets along the track [m]
    ahead: by day from which on, how many metres along the track all sets are ahead
    created: days when the sets were made
    """
    days = np.asarray(days, float)
    shift = noise * np.random.default_rng(1).normal(size=len(days))
    for begin, metres in (ahead or {}).items():
        shift += np.where(days >= begin, metres, 0.0)
    first = satellite(dict(zip(["t", *ELEMENTS], [0.0, *FIRST, 0.0], strict=True)))
    minutes = days * DAY / 60.0
    motion, eccentricity, inclination, node, perigee, anomaly = FIRST
    columns = {
        "t": days * DAY,
        "mean_motion": motion,
        "eccentricity": eccentricity,
        "inclination": inclination,
        "raan": (node + first.nodedot * minutes) % (2 * np.pi),
        "argp": (perigee + first.argpdot * minutes) % (2 * np.pi),
        "mean_anomaly": (anomaly + first.mdot * minutes + shift / 6.78e6) % (2 * np.pi),
        "bstar": bstar,
        "t_created": np.nan if created is None else np.asarray(created, float) * DAY,
    }
    return pd.DataFrame(columns)


def tle_text(sets, number=25544, launch=""):
    """The sets as TLEs of a catalogue number and a designator."""
    satellites = [satellite(sets.iloc[k]) for k in range(len(sets))]
    return "".join(line + "\n" for one in satellites for line in tle.lines(one, number, launch))
