"""Burns that nobody named: looked for where the newest estimates are far off what was flown.

A storm or a track of another object puts estimates off, too. Whether a burn does, the tracks themselves tell
(`opml.catalog.associate.quarantine`), all of the last days in turn.
"""

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.catalog.associate import quarantine
from opml.learning.judge.error_sizes import along_track
from opml.mornings.fits import Fitting
from opml.orbits.manoeuvres import Manoeuvre

FAR = 6.0
"""Standard deviations off from which on estimates may be of another orbit."""

_NEWEST = 3
"""Estimates that are off in the median."""

_FRESH = 2.0 * DAY
"""Ephemerides that are held against them are no older [s]."""

_APART = 0.25 * DAY
"""Time between two burns that are told apart [s]: the same one may be found a little later."""


def are_far(judged: pd.DataFrame) -> bool:
    """Return whether the newest estimates are far off the newest ephemerides before them.

    judged: rows of that table of one morning
    """
    flown = judged[np.isfinite(judged["sigma_y"]) & (judged["duration"] < _FRESH)]
    nearest = flown.loc[flown.groupby("j")["duration"].idxmin()].nlargest(_NEWEST, "t_j")
    return len(nearest) == _NEWEST and bool(np.median(sigmas_off(nearest)) > FAR)


def sigmas_off(rows: pd.DataFrame) -> np.ndarray:
    """Return how far off (n,) along the track ephemerides were, in the standard deviations of that."""
    return rows["e_y"].abs().to_numpy(float) / along_track(rows)


def newest(fitting: Fitting, kept: pd.DataFrame, *, since: float) -> Manoeuvre | None:
    """Return the newest burn that the tracks of the last days show, which windows of fits begin anew behind.

    kept: estimates of earlier mornings, whose states the fits may start from
    since: when the last burn was that is known [s]
    """
    found = quarantine.estimate_all(
        fitting.flight,
        fitting.starts(kept),
        fitting.measured,
        settings=fitting.settings.evolve(suspect_sigma=FAR),
    )
    times = found.loc[found["burn_t"] > since + _APART, "burn_t"]
    return Manoeuvre(float(times.iloc[-1]), anew=True) if len(times) else None
