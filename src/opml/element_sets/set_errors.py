"""Errors of SGP4 from the newest sets of mornings, at later sets and at those before.

A row is an object, a morning and a lead. SGP4 propagates the newest set that was known on the morning; the
state of the later set nearest to morning plus lead, at its own epoch, judges it. Where no later set is at
hand, as today, the row is at morning plus lead and has no error.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY
from opml.element_sets.catalogue import ElementCatalogue
from opml.interop.element_sets.element_set import perturb_drag, propagate
from opml.orbits.elements import bent_rsw
from opml.tables import IMPROVED_LEADS

LEADS = IMPROVED_LEADS  # days from the morning to what is predicted
BACK = 5  # sets before the newest one that it is compared with
OLDEST = 3.0  # age of the newest set [d] beyond which an object has no prediction on a morning
REACH = 0.5  # largest distance of the set that judges from morning plus lead [d]
_STEP = 0.05  # part of B* by which it is changed to see what SGP4 makes of it
_SPAN = 1e6  # more days than any table has
_MINUTES = 1440.0


def build(catalogue: ElementCatalogue, mornings: np.ndarray) -> tuple[pd.DataFrame, np.ndarray]:
    """Return the rows of mornings (n,), modified Julian days (UTC), ascending, and distances (sets, BACK).

    Columns: number, morning (modified Julian day), lead [d], newest (row of the catalogue), tau (days from
    the epoch of the newest set to what is predicted), judged (when the judge was known, NaN without one),
    error (SGP4 less the judge, along the track [m], NaN without one), response (of the along-track position
    to B* [m earth radii]).

    The distances, along the track [m], are those of a set that SGP4 carries back from each of the sets before
    it, the one before it first; NaN where there is none.
    """
    rows, judges = find(catalogue, mornings)
    vectors = [one.sgp4_tsince(0.0)[1:] for one in catalogue.satellites]
    positions, velocities = np.array(vectors, dtype=float).reshape(-1, 2, 3).transpose(1, 0, 2)
    ahead, ahead_velocities, perturbed, back = _propagate(catalogue, rows)
    # Those of row -1, where nothing judges, have no meaning.
    error = np.where(judges >= 0, along_track(ahead, positions[judges], velocities[judges]), np.nan)
    moved = along_track(perturbed, ahead, ahead_velocities)
    bstar = catalogue.table["bstar"].to_numpy()[rows["newest"]]
    with np.errstate(divide="ignore", invalid="ignore"):
        rows = rows.assign(error=error, response=moved / (_STEP * bstar))
    earlier = np.maximum(np.arange(len(positions))[:, None] - np.arange(1, BACK + 1), 0).ravel()
    distances = along_track(back.reshape(-1, 3), positions[earlier], velocities[earlier])
    return rows, distances.reshape(-1, BACK)


def along_track(positions: np.ndarray, reference: np.ndarray, velocities: np.ndarray) -> np.ndarray:
    """Return the arc (n,) [m] along an orbit from its positions to others, all (n, 3) [km] in one frame."""
    radius = np.linalg.norm(reference, axis=1)
    x = reference / radius[:, None]
    ahead = velocities - np.sum(velocities * x, axis=1)[:, None] * x
    y = ahead / np.linalg.norm(ahead, axis=1)[:, None]
    angle = np.arctan2(np.sum(positions * y, axis=1), np.sum(positions * x, axis=1))
    return np.asarray(1e3 * radius * angle)


def in_rsw(catalogue: ElementCatalogue, mornings: np.ndarray, leads: Sequence[int]) -> pd.DataFrame:
    """Return the rows that are judged of mornings (n,), as of `build`, with errors r, s, w [m]."""
    rows, judges = find(catalogue, mornings, leads)
    rows, judges = rows[judges >= 0].reset_index(drop=True), judges[judges >= 0]
    propagated = [
        catalogue.satellites[one].sgp4_tsince(_MINUTES * tau)[1]
        for one, tau in zip(rows["newest"], rows["tau"], strict=True)
    ]
    reference = [np.concatenate(catalogue.satellites[one].sgp4_tsince(0.0)[1:]) for one in judges]
    errors = 1e3 * bent_rsw(np.reshape(propagated, (-1, 3)), np.reshape(reference, (-1, 6)))
    return rows.assign(**dict(zip("rsw", errors.T, strict=True))).dropna()


def find(
    catalogue: ElementCatalogue, mornings: np.ndarray, leads: Sequence[int] = LEADS
) -> tuple[pd.DataFrame, np.ndarray]:
    """Return the rows without errors, by object, morning and lead, and the sets (rows,) that judge, or -1."""
    table = catalogue.table
    numbers, place = np.unique(table["number"].to_numpy(), return_inverse=True)
    t = table["t"].to_numpy()
    first = np.searchsorted(place, np.arange(len(numbers)))
    ends = np.searchsorted(place, np.arange(len(numbers)), side="right")
    objects = np.repeat(np.arange(len(numbers)), len(mornings))
    morning = np.tile(mornings, len(numbers))
    known = np.maximum.accumulate(_ordered(place, table["known"].to_numpy()))
    newest = np.searchsorted(known, _ordered(objects, morning), side="right") - 1
    fresh = newest >= first[objects]
    fresh[fresh] &= morning[fresh] - t[newest[fresh]] <= OLDEST
    objects, morning, newest = (np.repeat(part[fresh], len(leads)) for part in (objects, morning, newest))
    lead = np.tile(leads, len(objects) // len(leads))
    target = morning + lead
    judge = _nearest(_ordered(place, t), _ordered(objects, target), first[objects], ends[objects])
    judge = np.where((judge > newest) & (np.abs(t[judge] - target) <= REACH), judge, -1)
    until = np.where(judge >= 0, t[judge], target)
    return pd.DataFrame(
        {
            "number": numbers[objects],
            "morning": morning,
            "lead": lead,
            "newest": newest,
            "tau": _days_between(t[newest], until),
            "judged": np.where(judge >= 0, table["known"].to_numpy()[judge], np.nan),
        }
    ), judge


def _ordered(place: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Return times that ascend over all objects: those of the object in place k lie k spans later."""
    return np.asarray(_SPAN * place + time)


def _nearest(times: np.ndarray, wanted: np.ndarray, first: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the rows (n,) from `first` to before `ends` whose time is nearest to the one wanted."""
    after = np.searchsorted(times, wanted)
    left, right = (np.clip(after - 1, first, ends - 1), np.clip(after, first, ends - 1))
    return np.where(wanted - times[left] <= times[right] - wanted, left, right)


def _days_between(earlier: np.ndarray, later: np.ndarray) -> np.ndarray:
    """Return the days (n,) of 86 400 SI seconds, leap seconds among them, between modified Julian days."""
    return np.asarray(later - earlier + epochs.leap_seconds(earlier, later) / DAY)


def _propagate(catalogue: ElementCatalogue, rows: pd.DataFrame) -> tuple[np.ndarray, ...]:
    """Return what SGP4 makes of the newest sets of rows, in TEME [km, km/s], NaN where it fails.

    Positions and velocities (rows, 3) at what is predicted, positions there with a larger B*, and positions
    (sets, BACK, 3) at the epochs of the sets before.
    """
    t, number = catalogue.table["t"].to_numpy(), catalogue.table["number"].to_numpy()
    newest, tau = rows["newest"].to_numpy(), rows["tau"].to_numpy()
    order = np.argsort(newest, kind="stable")
    sets, begins = np.unique(newest[order], return_index=True)
    positions, velocities, perturbed = (np.full((len(rows), 3), np.nan) for _ in range(3))
    back = np.full((len(t), BACK, 3), np.nan)
    for one, members in zip(sets, np.split(order, begins)[1:], strict=True):
        earlier = np.arange(one - 1, max(one - BACK, 0) - 1, -1)
        earlier = earlier[number[earlier] == number[one]]
        minutes = _MINUTES * np.concatenate([_days_between(t[one], t[earlier]), tau[members]])
        satellite, known = catalogue.satellites[one], len(earlier)
        places, speeds = propagate(satellite, minutes)
        back[one, :known] = places[:known]
        positions[members], velocities[members] = places[known:], speeds[known:]
        perturbed[members] = propagate(perturb_drag(satellite, _STEP), minutes[known:])[0]
    return positions, velocities, perturbed, back
