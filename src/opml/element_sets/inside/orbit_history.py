"""The orbit of an object over the span of its public sets: the orbits inside them, joined.

    history = orbit_history.find(["sets.tle"], begin="2018-12-01T00:00:00")
    history.write("past.oem")

The last set of each day has its orbit, under the weather as it was measured before its epoch and after it: of
the past all is known. Between the epochs of two sets their orbits are joined smoothly. Burns, gaps, and weeks
whose sets have no orbit inside separate them into segments.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.constants import DAY, EARTH_GM
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.progress import Progress
from opml.element_sets.inside import inside_forces, inside_now
from opml.element_sets.inside.inside_forces import Forces
from opml.element_sets.inside.inside_sizes import FLOOR
from opml.element_sets.inside.orbit_inside import EVERY, NoOrbitError, paths
from opml.element_sets.inside.past_orbits import PastOrbits
from opml.interop import ccsds, oem
from opml.interop.element_sets import known_sets
from opml.interop.element_sets.burns_in_sets import KnownSet, burns_among
from opml.interop.element_sets.element_set import decay, elements_epoch
from opml.interop.ephemeris import Ephemeris
from opml.interop.object_ids import ObjectId
from opml.orbits.elements import bent_rsw, coe_from_cartesian, in_rsw
from opml.orbits.rsw_covariance import position_covariances
from opml.orbits.state_polynomials import StatePolynomials

STEP = 120.0  # between states [s]
GAP = 4.0 * DAY  # most between sets whose orbits are joined [s]
NEAR = 0.25 * DAY  # least between them [s]
TURNED = 300.0  # by what no plane turns without a burn [m]
_TIMES_USUAL = 8.0  # least ratio of a change of size that parts orbits to the usual one
_DAYS = 30  # sets that tell a span together
_BESIDE = 10.0 * DAY  # sets so long before a time and after it count for it [s]
_COVARIANCE_EVERY = 5  # states
_MINUTES, _DAY = len("2016-09-28T12:09"), len("2016-09-28")
_AVERAGED = 5  # intervals between sets whose disagreement counts at a time


@dataclass(frozen=True, eq=False)
class _Passage:
    """The orbit inside a set about its epoch t, and when all that makes it was known [s]; sinking: [m/d]."""

    t: float
    known: float
    path: StatePolynomials
    sinking: float


@dataclass(frozen=True)
class OrbitChange:
    """A change of the orbit between the epochs of two sets [s]: its growth, and the turn of its plane [m].

    is_burn: whether mean elements show a burn there; else only the orbits inside the sets are apart
    """

    begin: float
    end: float
    larger: float
    turned: float
    is_burn: bool


def _change(earlier: _Passage, later: _Passage, is_burn: bool) -> OrbitChange:
    """Return what the orbit of a set changes against the one before, at its epoch or GAP after that's."""
    t = np.array([min(later.t, earlier.t + GAP)])
    own, other = (one.path.at(t) for one in (earlier, later))
    sizes = coe_from_cartesian(np.concatenate([own, other]), EARTH_GM)[:, 0]
    (off,), radius = in_rsw(own - other, other), np.linalg.norm(other[0, :3])
    turned = float(np.hypot(off[2], off[5] * radius / np.linalg.norm(other[0, 3:])))
    return OrbitChange(earlier.t, later.t, float(sizes[1] - sizes[0]), turned, is_burn)


def _is_jump(change: OrbitChange, sinking: float, usual: float) -> bool:
    """Return whether drag made no such change; sinking: decay [m/d], usual: median change of size [m]."""
    days = (change.end - change.begin) / DAY
    least = max(float(inside_now.least_burn(sinking, days)), _TIMES_USUAL * usual)
    return change.is_burn or abs(change.larger) > least or change.turned > TURNED


def _joined(earlier: _Passage, later: _Passage, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the states (n, 6) of two orbits as one, at times (n,) between their epochs, and what they
    differ by: root mean squares (3,) in RSW [m].
    """
    gap = later.t - earlier.t
    since = ((t - earlier.t) / gap)[:, None]
    own, other = earlier.path.at(t), later.path.at(t)
    # A part of which the rate is 0 at both epochs: no velocity jumps there.
    states = own + since**2 * (3.0 - 2.0 * since) * (other - own)
    states[:, 3:] += 6.0 * since * (1.0 - since) / gap * (other - own)[:, :3]
    return states, np.sqrt((bent_rsw(other[:, :3], own) ** 2).mean(axis=0))


def _segments(
    passages: Sequence[_Passage], identity: ObjectId, begin: float, end: float
) -> Iterator[Ephemeris]:
    """Yield the ephemeris of orbits without a gap from the first epoch to the last, within two times [s].

    What two orbits differ by is the error of both. What all sets have in common is added.
    """
    epoch = np.array([one.t for one in passages])
    t = STEP * np.arange(np.ceil(epoch[0] / STEP), np.floor(epoch[-1] / STEP) + 1.0)
    interval = np.searchsorted(epoch[1:-1], t, side="right")
    parts = [_joined(passages[k], passages[k + 1], t[interval == k]) for k in range(len(passages) - 1)]
    states = np.concatenate([part for part, _ in parts])
    errors = pd.DataFrame([0.5 * differences**2 for _, differences in parts])
    own = np.sqrt(errors.rolling(_AVERAGED, min_periods=1, center=True).mean().to_numpy())
    sigmas = np.hypot(own, [FLOOR[axis] for axis in "rsw"])[interval]
    wanted = np.flatnonzero((begin <= t) & (t <= end))
    if len(wanted) > 1:
        sparse = np.unique(np.append(wanted[::_COVARIANCE_EVERY], wanted[-1]))
        yield Ephemeris(
            identity.name,
            t[wanted],
            states[wanted],
            t[sparse],
            position_covariances(sigmas[sparse], states[sparse]),
            covariance_frame="RSW",
            remark="orbits inside public sets, joined, under the weather as measured since",
            degree=7,
            identity=identity,
            known=passages[-1].known,
        )


@dataclass(frozen=True, eq=False)
class OrbitHistory:
    """The orbit of an object, its changes, and when its sets have no orbit inside, with the reason, in words.

    segments: between changes, gaps and doubtful sets, times since `epoch` (UTC text)
    """

    epoch: str
    segments: Sequence[Ephemeris]
    changes: Sequence[OrbitChange]
    published: Sequence[str]

    def write(self, path: FilePath) -> None:
        """Write the ephemeris with covariances as an OEM."""
        oem.write(path, self.segments, epoch=self.epoch)

    def summary(self) -> str:
        """Return a line a segment, with the medians of its sigmas, a change, and a reason."""
        published = (f"as published: {one}" for one in self.published)
        return "\n".join([*map(self._line, self.segments), *map(self._change_line, self.changes), *published])

    def _change_line(self, change: OrbitChange) -> str:
        times = ccsds.utc_texts(self.epoch, np.array([change.begin, change.end]))
        begin, end = (text[:_MINUTES] for text in times)
        what = "a burn" if change.is_burn else "a change without a burn in the mean elements"
        size = f"{abs(change.larger):.1f} m {'larger' if change.larger > 0.0 else 'smaller'}"
        turned = f"its plane turned by {change.turned:.0f} m"
        return f"{what} between {begin} and {end}: the orbit is {size}, {turned}"

    def _line(self, segment: Ephemeris) -> str:
        begin, end = (text[:_MINUTES] for text in ccsds.utc_texts(self.epoch, segment.t[[0, -1]]))
        variances = np.diagonal(segment.covariances, axis1=1, axis2=2)[:, :3]
        sigmas = " ".join(f"{sigma:.0f}" for sigma in np.sqrt(np.median(variances, axis=0)))
        return f"{begin} to {end}: one sigma outwards, along, across [m]: {sigmas}; {segment.remark}"


def find(
    sets: FilePath | Sequence[FilePath],
    *,
    object: str | int | None = None,
    begin: str | None = None,
    end: str | None = None,
    weather: str | Path = "OBSERVED",
    progress: Progress = lambda line: None,
) -> OrbitHistory:
    """Return where an object was over the span of its public sets.

    sets: a file or folder, or several, of TLEs or OMMs
    object: name, designator or number, where the files have several objects
    begin, end: UTC texts; None: the first set, and the last one
    weather: OBSERVED, the packaged weather, or a CSSI file

    Raises InputError for unreadable files, an object that is not there, no orbit inside any set, and weather
    that does not reach.
    """
    files = [sets] if isinstance(sets, (str, os.PathLike)) else list(sets)
    history = known_sets.of_object(files, None if object is None else str(object))
    epoch = f"{elements_epoch(history[0].satellite)[:_DAY]}T00:00:00"
    first = -np.inf if begin is None else epochs.seconds_between(epoch, begin)
    last = np.inf if end is None else epochs.seconds_between(epoch, end)
    public = [
        [one for one in stretch if first - _BESIDE <= one.t <= last + _BESIDE]
        for stretch in _unbroken(known_sets.since(epoch, history), epoch)
    ]
    passages, burned, published = _orbits(public, epoch, weather, progress)
    changes, cuts = _changes(passages, burned)
    identity = known_sets.identity(history[-1])
    parts = np.split(np.arange(len(passages)), 1 + cuts)
    segments = [
        segment
        for rows in parts
        if len(rows) > 1  # one is joined with none
        for segment in _segments([passages[row] for row in rows], identity, first, last)
    ]
    if not segments:
        reasons = "; ".join(published) or "too few"
        raise InputError(f"{files[0]}: expected sets with an orbit inside, got none: {reasons}")
    inside = [one for one in changes if first <= one.begin and one.end <= last]
    return OrbitHistory(epoch, segments, inside, published)


def _orbits(
    public: Sequence[Sequence[KnownSet]], epoch: str, weather: str | Path, progress: Progress
) -> tuple[list[_Passage], set[int], list[str]]:
    """Return orbits inside sets by epoch, after which of them the mean elements show burns, and which sets
    have none, with the reason, in words; public: sets by the stretches between burns.
    """
    passages: list[_Passage] = []
    burned: set[int] = set()
    published: list[str] = []
    for stretch in public:
        for month in _months(stretch):
            dates = ccsds.utc_texts(epoch, np.array([month[0].t, month[-1].t]))
            days = " to ".join(text[:_DAY] for text in dates)
            progress(f"the orbits inside the sets from {days}")
            try:
                passages.extend(_passages(month, epoch, weather))
            except NoOrbitError as reason:
                published.append(f"{days}: {reason}")
        burned.add(len(passages) - 1)
    return passages, burned - {-1, len(passages) - 1}, published


def _changes(passages: Sequence[_Passage], burned: set[int]) -> tuple[list[OrbitChange], np.ndarray]:
    """Return burns and jumps of the orbit, and after which passages (cuts,) it is not joined: gaps, too."""
    changes = [_change(*pair, k in burned) for k, pair in enumerate(pairwise(passages))]
    gaps = {k for k, one in enumerate(changes) if one.end - one.begin > GAP}
    usual = float(np.median([abs(one.larger) for one in changes])) if changes else 0.0
    jumps = {k for k, one in enumerate(changes) if _is_jump(one, passages[k].sinking, usual)}
    merged = _merged([changes[k] for k in sorted(burned | jumps - gaps)])
    return merged, np.sort([*(gaps | jumps)]).astype(int)


def _months(daily: Sequence[KnownSet]) -> Iterator[Sequence[KnownSet]]:
    """Yield the sets that tell their span together; one alone has none that its orbit is joined with."""
    if len(daily) > 1:
        for rows in np.array_split(np.arange(len(daily)), -(-len(daily) // _DAYS)):
            yield [daily[row] for row in rows]


def _merged(changes: Sequence[OrbitChange]) -> list[OrbitChange]:
    """Return changes; those between sets that follow each other are one, as of sets from both sides of it."""
    merged: list[OrbitChange] = []
    for change in changes:
        if merged and merged[-1].end == change.begin:
            last = merged.pop()
            larger, turned = last.larger + change.larger, max(last.turned, change.turned)
            change = OrbitChange(last.begin, change.end, larger, turned, last.is_burn or change.is_burn)
        merged.append(change)
    return merged


def _unbroken(sets: Sequence[KnownSet], epoch: str) -> Iterator[list[KnownSet]]:
    """Yield the sets of a day between burns: from when one is known to the next one."""
    begin = -np.inf
    burns = burns_among(sets, epoch=epoch)
    for end, counts_from in [*((one.t, one.counts_from) for one in burns), (np.inf, np.inf)]:
        daily = inside_now.last_of_days([one for one in sets if begin <= one.t < end])
        gaps = np.diff([one.t for one in daily], append=np.inf)
        yield [one for one, gap in zip(daily, gaps, strict=True) if gap >= NEAR]
        begin = counts_from


def _passages(daily: Sequence[KnownSet], epoch: str, weather: str | Path) -> list[_Passage]:
    """Return the orbits inside sets about their epochs, reaching as far as those are joined.

    Raises NoOrbitError where they have none.
    """
    newest = daily[-1].satellite
    if reason := inside_now.unsuited(newest):
        raise NoOrbitError(reason)
    first, last = (float(np.sum(epochs.utc(epoch, one.t)) - epochs.MJD_ZERO) for one in (daily[0], daily[-1]))
    forces = inside_forces.read(weather, first=first, last=last)
    now = forces.time(epoch)
    sets = [replace(one, t=now + one.t, made=np.inf) for one in daily]
    past, calibration, _ = inside_now.daily_orbits(sets, forces)
    if doubt := inside_now.doubt(calibration, newest, elements_epoch(newest)):
        raise NoOrbitError(doubt)
    t = np.array([one.t for one in daily])
    known = np.maximum(t, np.minimum(t + calibration.span.after, forces.model.issued[-1] - now))
    flown = _paths(past, past.numbers(calibration.span, calibration.sunlight), forces)
    return [
        _Passage(own, at, StatePolynomials(times - now, states), decay(newest))
        for own, at, (times, states) in zip(t, known, flown, strict=True)
    ]


def _paths(past: PastOrbits, numbers: np.ndarray, forces: Forces) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield times (n,) [s] and states (n, 6) of orbits from before the epoch of a set to that of the next.

    numbers: (sets, 8) as of `PastOrbits.numbers`
    """
    t, begins = past.t, [orbit.begin_again(own) for orbit, own in zip(past.orbits, numbers, strict=True)]
    # The neighbours of the first and of the last may be those of other weeks.
    gaps = np.minimum(np.diff(t, prepend=t[0] - GAP, append=t[-1] + GAP), GAP) + EVERY
    ends = STEP * np.stack([np.floor((t - gaps[:-1]) / STEP), np.ceil((t + gaps[1:]) / STEP)])
    for begin, states in zip(ends[0], paths(forces, begins, ends, every=STEP), strict=True):
        yield begin + STEP * np.arange(len(states)), states
