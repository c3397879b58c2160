"""The orbit inside an object's newest sets, from a date on, and how far its like were off in the weeks
before.

    forces = inside_now.forces_on("2018-12-25T06:00:00", "OBSERVED")
    now = inside_now.find(public, date="2018-12-25T06:00:00", forces=forces)
    now.calibration, now.predict(days=7.0)

Each set of a day of the last weeks has its orbit, under the weather as it was known. They calibrate:
they tell the span, how well sets agree over it and what errors the newest orbit will have; that has its own
set and those shortly before it. A calibration holds for some days, and is kept.
"""

import hashlib
from collections.abc import Callable, MutableMapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from sgp4.api import Satrec

from opml.base import epochs
from opml.base.constants import DAY, HOUR, WGS84_A
from opml.base.provenance import code_digest
from opml.dynamics.ensemble import Arcs
from opml.element_sets.inside import inside_forces, past_orbits
from opml.element_sets.inside.inside_forces import ON_ALL_CORES, Forces
from opml.element_sets.inside.orbit_inside import (
    DRAG,
    EVERY,
    LEAST_DRAG,
    NUMBERS,
    NearbyOrbit,
    NoOrbitError,
    begin_at,
    departing,
    first_drag,
    orbits_beside,
    size_change,
    solve,
    usual_half_span,
)
from opml.element_sets.inside.past_orbits import LONGEST, SPANS, Calibration, PastOrbits, centred
from opml.element_sets.inside.set_orbits import gauged
from opml.element_sets.set_errors import OLDEST
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import DEEP_SPACE, decay, seconds_since, semi_major_axis

LOWEST = 180e3  # height of the perigee below which an orbit ends before its span does [m]
PAST = 21.0  # days before the newest set whose sets tell the span and the errors
MOST = 12  # sets of these, at least a day from each other

CALIBRATED_EVERY = 4
"""Days between the calibrations of an object: on a morning a quarter of a catalogue has new ones."""

_FORCES_EVERY = 32.0  # days between the epochs of forces: those of a calibration are the same for some days

BEFORE = 4.0
"""Days before the newest set whose sets count with it, where drag is hardly felt."""

STEADY = 6.0  # decay [m/d] below which they do, and drag parts no orbits outwards

MODERN = "2015"
"""Year from which a set that stands alone is taken to have an orbit inside."""

FARTHEST, FARTHEST_DRAGGED = 40.0, 100.0
"""Distance across the track to which sets with an orbit inside agree at least [m], with little and much drag.

Those of Jason-2 in 2008 agree to 60 m, and their orbits are as far off as SGP4's.
"""

AGREED = 0.7
"""Largest part of the errors of SGP4's predictions, outwards and across, that those of orbits inside have."""

AGREED_BEFORE = 0.4
"""The same for spans before the epochs: those of older sets share what no radar saw, and agree too well."""

LEAST_BURN = 1.0
"""Change of an orbit's size that shows a burn [m]: of Sentinel-3A's sets it is 0.1 m from day to day, and the
smallest burn of 2018 was one of 3 m."""

_DRAG_ERROR = 0.25  # part of the decay by which a forecast of it may be off

LITTLE_DRAG = 22.0  # decay [m/d] below which light determines more than drag, and spans are long
_SHORT = 96.0 * HOUR  # half of the longest span that is tried where drag is not small [s]
_STEP = 300.0  # between the states of a prediction [s]


@dataclass(frozen=True, eq=False)
class InsideNow:
    """The orbit inside the newest sets of an object.

    date: UTC text from which it is predicted; age: of the newest set on it [d]
    calibration: by past sets
    orbit, numbers: that near the newest set, and the changes that make it the one inside
    """

    forces: Forces
    date: str
    age: float
    calibration: Calibration
    orbit: NearbyOrbit
    numbers: np.ndarray

    def ahead_of_sgp4(self, days: np.ndarray) -> np.ndarray:
        """Return how far SGP4 from the newest set is ahead of the orbit (n,) [m], a revolution's mean.

        days: (n,) from the date on
        """
        off = self.orbit.displacements(self.orbit.beginning.satellite) - self.orbit.partials @ self.numbers
        now = self.forces.time(self.date)
        since = (self.orbit.t - now) / DAY
        there = (since >= -0.5) & np.isfinite(off[:, 1])
        smooth = np.polynomial.Polynomial.fit(since[there], off[there, 1], 3)
        return np.asarray(smooth(days))

    def predict(self, days: float, along_track: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return times (n,) [s since the date] and GCRF states (n, 6) of the orbit from before the date on.

        along_track: (leads, 3) days from the date, by what the orbit is to be ahead there [m], and the
        standard deviation of that; its energy and its drag change so as to come near
        """
        begin = self.orbit.begin_again(self.numbers + self._shifted(along_track))
        now = self.forces.time(self.date)
        t = np.arange(begin.t, now + DAY * days + 2.0 * _STEP, _STEP)
        first, last = np.zeros(1, int), np.array([len(t) - 1])
        arcs = self.forces.propagate(t, departing([begin], self.forces, first=first, last=last))
        wanted = slice(max(int((now - begin.t) // _STEP) - 1, 0), None)
        return (t - now)[wanted], np.concatenate([begin.state[None], arcs.path(0)])[wanted]

    def _shifted(self, along_track: np.ndarray | None) -> np.ndarray:
        """Return changes (7,), of mean motion, argument of latitude and Cd A/m, that come near to a shift."""
        changes = np.zeros(NUMBERS)
        if along_track is None:
            return changes
        days, ahead, sigma = along_track.T
        t = self.forces.time(self.date) + DAY * days
        places = np.clip(np.searchsorted(self.orbit.t, t), 0, len(self.orbit.t) - 1)
        design, sought = self.orbit.partials[places, 1] / sigma[:, None], ahead / sigma
        free = [_MOTION, _LATITUDE, DRAG]
        changes[free] = np.linalg.lstsq(design[:, free], sought, rcond=None)[0]
        least = (LEAST_DRAG - self.orbit.ballistic(self.numbers)) / self.orbit.beginning.drag_step
        if changes[DRAG] < least:  # some of the drag stays: without it an orbit would rise
            changes[DRAG], free = least, [_MOTION, _LATITUDE]
            rest = sought - least * design[:, DRAG]
            changes[free] = np.linalg.lstsq(design[:, free], rest, rcond=None)[0]
        return changes


_MOTION, _LATITUDE = 0, 5  # places of elements among the numbers


def doubt(calibration: Calibration, newest: Satrec, date: str) -> str:
    """Return why sets of a date have no orbit inside, in words; '' where they have one.

    newest: the last of the sets
    """
    if not calibration.is_told:
        is_old = date < MODERN
        return "its sets are of years when publishers fitted otherwise, and too few to tell" if is_old else ""
    middle = calibration.errors.median()
    own, by_sgp4 = (float(np.hypot(*middle[list(axes)])) for axes in (("r", "w"), ("sgp4_r", "sgp4_w")))
    if calibration.w > (FARTHEST if decay(newest) < LITTLE_DRAG else FARTHEST_DRAGGED):
        return f"orbits of its sets agree to {calibration.w:.0f} m across the track"
    if own > by_sgp4 * (AGREED if calibration.span.is_centred else AGREED_BEFORE):
        return f"orbits of its sets agree to {own:.0f} m, SGP4's to {by_sgp4:.0f} m"
    return ""


def daily_orbits(
    daily: Sequence[KnownSet], forces: Forces, others: Sequence[KnownSet] = ()
) -> tuple[PastOrbits, Calibration, list[NearbyOrbit]]:
    """Return the orbits near sets, by epoch, one of a day, and what they tell; and those near other sets.

    Times of sets are since the epoch of the forces. Raises NoOrbitError where they have none.
    """
    newest = daily[-1].satellite
    longest = _longest(newest)
    orbits = _orbits(forces, [[one] for one in others] + [daily], longest, is_lit=_is_lit(newest))
    beside, own = orbits[: len(others)], orbits[len(others) :]
    equations = [orbit.equations(one.satellite) for one, orbit in zip(daily, own, strict=True)]
    past = PastOrbits(np.array([one.t for one in daily]), own, equations)
    spans = [one for one in SPANS if max(one.before, one.after) <= longest]
    agreed = past_orbits.agreement(past, spans, axes=("r", "w") if decay(newest) < STEADY else ("w",))
    span, r, w = agreed or (centred(usual_half_span(newest)), np.nan, np.nan)
    sunlight = past.sunlight(span) if _is_lit(newest) else 0.0
    return past, Calibration(span, r, w, sunlight, past.errors(past.numbers(span, sunlight))), beside


def _is_lit(satellite: Satrec) -> bool:
    """Return whether sets with such a decay tell the pressure of light."""
    return decay(satellite) < LITTLE_DRAG


def _longest(satellite: Satrec) -> float:
    """Return half of the longest span that is tried with such a decay [s]."""
    return LONGEST if _is_lit(satellite) else _SHORT


def forces_on(date: str, weather: str | Path, *, propagator: Callable[..., Arcs] = ON_ALL_CORES) -> Forces:
    """Return the forces for the orbits inside all sets that were known on a date (UTC text).

    Raises InputError for weather that does not reach.
    """
    today = epochs.mjd(date)
    first = today - PAST - OLDEST - CALIBRATED_EVERY
    first = _FORCES_EVERY * np.floor(first / _FORCES_EVERY)
    return inside_forces.read(weather, first=first, last=today, propagator=propagator)


def find(
    public: Sequence[KnownSet],
    *,
    date: str,
    forces: Forces,
    kept: MutableMapping[str, Calibration] | None = None,
) -> InsideNow:
    """Return the orbit inside the newest of an object's sets.

    public: sets that were known on the date (UTC text), none from before its last burn, by epoch; times since
    the date; the newest at most OLDEST days old
    forces: of `forces_on` that date
    kept: calibrations of this morning and earlier ones; takes that of the object, if it holds for some days
    """
    now = forces.time(date)
    t = seconds_since(forces.epoch, [one.satellite for one in public])
    sets = [replace(one, t=own, made=now + one.made) for one, own in zip(public, t.tolist(), strict=True)]
    newest = sets[-1]
    forces = forces.above(perigee(newest.satellite))
    calibration, orbit = _calibrated(sets, date, forces, {} if kept is None else kept)
    span = calibration.span
    parts = [orbit.equations(newest.satellite).over(newest.t - span.before, newest.t + span.after)]
    begin = orbit.begin_again(solve(orbit, parts, sunlight=calibration.sunlight))
    before = BEFORE if decay(newest.satellite) < STEADY else 0.0
    counted = [one for one in sets if newest.t - one.t <= DAY * before]
    [orbit] = orbits_beside(
        forces,
        [begin],
        back=np.array([span.before + newest.t - counted[0].t + EVERY]),
        ahead=np.array([max(past_orbits.REACH + now - newest.t, span.after + EVERY)]),
    )
    parts = [orbit.equations(one.satellite).over(one.t - span.before, one.t + span.after) for one in counted]
    ages = np.array([(newest.t - one.t) / DAY for one in counted])
    final = solve(orbit, parts[_first_of_one_size(orbit, parts, ages) :])
    return InsideNow(forces, date, (now - newest.t) / DAY, calibration, orbit, final)


def _calibrated(
    sets: Sequence[KnownSet], date: str, forces: Forces, kept: MutableMapping[str, Calibration]
) -> tuple[Calibration, NearbyOrbit]:
    """Return what the sets of the weeks before a day tell, and the orbit near the newest.

    The day is one in CALIBRATED_EVERY, by the object's number; that of the date while few sets were known.
    """
    newest, day = sets[-1], int(epochs.mjd(date))
    day -= (day - newest.satellite.satnum) % CALIBRATED_EVERY
    utc = epochs.calendar(day)
    daily = _of_weeks([one for one in sets if one.made <= forces.time(f"{utc}T00:00:00")])
    if len(daily) < MOST // 2:
        past, calibration, _ = daily_orbits(_of_weeks(sets), forces)
        return calibration, past.orbits[-1]
    key = f"{utc} {_digest(daily, forces)}"
    if key not in kept:
        _, kept[key], [orbit] = daily_orbits(daily, forces, [newest])
        return kept[key], orbit
    last = daily[-1].satellite
    [orbit] = _orbits(forces, [[newest]], _longest(last), is_lit=_is_lit(last))
    return kept[key], orbit


def _of_weeks(sets: Sequence[KnownSet]) -> list[KnownSet]:
    """Return the sets of the last PAST days, one of a day and MOST at most."""
    return _thinned(last_of_days([one for one in sets if one.t >= sets[-1].t - DAY * PAST]))


def _digest(daily: Sequence[KnownSet], forces: Forces) -> str:
    """Return a digest of all that makes a calibration: sets, forces under the weather then, and the code."""
    digest = hashlib.sha256(_code().encode())
    for one in daily:
        own = one.satellite
        elements = own.no_kozai, own.ecco, own.inclo, own.nodeo, own.argpo, own.mo, own.bstar, own.ndot
        digest.update(np.array([own.satnum, one.t, np.round(one.made), *elements]).tobytes())
    known = max(one.made for one in daily)
    digest.update(forces.digest(known, daily[-1].t + past_orbits.REACH + DAY))
    return digest.hexdigest()


@cache
def _code() -> str:
    return code_digest(__name__)


def _first_of_one_size(
    orbit: NearbyOrbit, parts: Sequence[tuple[np.ndarray, np.ndarray]], ages: np.ndarray
) -> int:
    """Return from which set on all have an orbit of the newest's size: those before it are of before a burn.

    parts: of the normal equations; ages: (sets,) days before the newest
    """
    newest, elements = solve(orbit, parts[-1:]), slice(DRAG)
    # With the drag of the newest: that of each set would be taken for a burn, and a burn for drag.
    motions = [
        np.linalg.lstsq(square[elements, elements], (moment - square @ newest)[elements])[0][_MOTION]
        for square, moment in parts
    ]
    satellite = orbit.beginning.satellite
    off = size_change(satellite, np.array(motions))
    parted = np.abs(off) > least_burn(decay(satellite), ages)
    return int(np.flatnonzero(parted).max(initial=-1)) + 1


def least_burn(sinking: float, days: np.ndarray | float) -> np.ndarray | float:
    """Return by how much an orbit's size changes in some days [m] that a burn made; sinking: decay [m/d]."""
    return LEAST_BURN + _DRAG_ERROR * max(sinking, 0.0) * days


def _orbits(
    forces: Forces, groups: Sequence[Sequence[KnownSet]], longest: float, *, is_lit: bool
) -> list[NearbyOrbit]:
    """Return the orbits near the sets of groups, each with the drag that the last of its group tells.

    They reach half the longest span [s] before and after their epochs, and to the last set within REACH.
    """
    drag = _gauges([group[-1] for group in groups], forces)
    begins = [
        begin_at(one, forces.epoch, ballistic)
        for group, ballistic in zip(groups, drag, strict=True)
        for one in group
    ]
    later = [group[-1].t - one.t + past_orbits.ABOUT for group in groups for one in group]
    ahead = np.clip(later, longest, max(longest, past_orbits.REACH)) + EVERY
    return orbits_beside(forces, begins, back=np.full(len(begins), longest), ahead=ahead, is_lit=is_lit)


def perigee(satellite: Satrec) -> float:
    """Return the height of the perigee of a set [m]."""
    return semi_major_axis(satellite.no_kozai) * (1.0 - satellite.ecco) - WGS84_A


def unsuited(satellite: Satrec) -> str:
    """Return why no orbit is sought inside a set, '' where one is."""
    if satellite.no_kozai < DEEP_SPACE:
        return "deep space"
    return "" if perigee(satellite) > LOWEST else f"perigee below {LOWEST / 1e3:g} km"


def last_of_days(sets: Sequence[KnownSet]) -> list[KnownSet]:
    """Return the last set of each day."""
    return list({np.floor(one.t / DAY): one for one in sets}.values())


def _thinned(sets: Sequence[KnownSet]) -> list[KnownSet]:
    """Return MOST sets at most, spread evenly, with the newest."""
    places = np.unique(np.round(np.linspace(len(sets) - 1, 0, min(len(sets), MOST))).astype(int))
    return [sets[k] for k in places]


def _gauges(sets: Sequence[KnownSet], forces: Forces) -> list[float]:
    """Return Cd A/m [m2/kg] of the orbits inside sets over the usual spans."""
    spans = np.array([2 * [usual_half_span(one.satellite)] for one in sets])
    begins = [begin_at(one, forces.epoch, float(first_drag(one.satellite.bstar))) for one in sets]
    drag = [one.ballistic for one in gauged(forces, begins, np.array([one.t for one in sets]), spans)]
    if not np.isfinite(drag).all():
        raise NoOrbitError("no orbit under full forces fits its sets")
    return drag
