"""Close approaches between ephemerides in files: OEM, with their covariances, and mean elements.

opml screen ours.oem others/*.oem catalogue.tle --within 5 --radius 20

What is not compared with ours is logged: ephemerides of our own object, and times that nothing is known of.
"""

import logging
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path as File

import numpy as np
import pandas as pd

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import approaches, cdm
from opml.conjunctions.approaches import Approach, Path
from opml.conjunctions.conjunction import Conjunction, Participant, check_length, check_radius
from opml.interop import ccsds, oem
from opml.interop.element_sets import histories, usual_errors
from opml.interop.element_sets.mean_elements import MOST_DAYS, WARN_DAYS
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import contents
from opml.orbits.density_error import DensityErrors
from opml.orbits.elements import rsw_rotation

EPOCH = "2000-01-01T12:00:00"
"""UTC text from which times of files count [s], to a microsecond."""

RADIUS = 20.0
"""Sum of the radii of two objects of which nothing is told [m]."""

WITHIN = 5.0
"""Distance that is near where nobody tells [km]."""

# Standard deviations of a position [m] beyond which it is told: one may be in another unit, or made up.
_WIDE, _EXACT = 1e5, 0.1

# Distances from the Earth's centre below which nothing orbits, and below which sets may descend steeply [m].
_LOWEST, _STEEP = WGS84_A + 80e3, WGS84_A + 200e3

COVARIANCE_HELD = 600.0
"""Time for which a covariance holds before the first and beyond the last that is known [s]."""

USUAL = "as sets at its height usually err"
"""What is told of a covariance that the object's own past has no part in."""

_SPARSE = 10  # states of a path from one of its covariances to the next
_SECONDS = len("2016-09-28T12:09:45")
_log = logging.getLogger(__name__)

Span = tuple[float, float]
"""When something begins and ends [s]."""


def covariances_at(known: np.ndarray, covariances: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return covariances (n, k, k) at times (n,) [s], linear between those known, NaN far from all.

    known: (m,) ascending [s]; covariances: (m, k, k) in RSW
    """
    if not len(known):
        return np.full((len(t), *covariances.shape[1:]), np.nan)
    after = np.clip(np.searchsorted(known, t), 1, len(known) - 1) if len(known) > 1 else np.zeros(len(t), int)
    before = np.maximum(after - 1, 0)
    share = np.clip((t - known[before]) / np.maximum(known[after] - known[before], 1e-9), 0.0, 1.0)
    share = share[:, None, None]
    between = (1.0 - share) * covariances[before] + share * covariances[after]
    is_near = (t >= known[0] - COVARIANCE_HELD) & (t <= known[-1] + COVARIANCE_HELD)
    return np.where(is_near[:, None, None], between, np.nan)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Where an object is expected for a while, and how surely.

    covariance_t: (m,) ascending [s]
    covariances: (m, 6, 6) in RSW [m, m/s]
    remark: what to know of these
    density: the part of these that other objects share; None where unknown
    """

    path: Path
    covariance_t: np.ndarray = field(default_factory=lambda: np.empty(0))
    covariances: np.ndarray = field(default_factory=lambda: np.empty((0, 6, 6)))
    remark: str = ""
    density: DensityErrors | None = None

    @property
    def span(self) -> Span:
        """When the trajectory begins and ends [s]."""
        return float(self.path.t[0]), float(self.path.t[-1])

    def covariance(self, t: float) -> np.ndarray | None:
        """Return the covariance at a time [s], linear between those that are known; None far from all."""
        found = covariances_at(self.covariance_t, self.covariances, np.array([t]))[0]
        return found if np.isfinite(found).all() else None


@dataclass(frozen=True, eq=False)
class ScreenedObject:
    """What a file knows of an object.

    identity: of the object
    source: the file's name
    trajectories: in the order of the file, none where the object has decayed, or its elements are too old
    known: when the newest was known that it is made from [s]
    elements_t: epoch of the mean elements that are flown [s]; None for states
    """

    identity: ObjectId
    source: str
    trajectories: Sequence[Trajectory]
    known: float
    elements_t: float | None = None

    def participant(self, trajectory: Trajectory, t: float) -> Participant:
        """Return the object at a time [s] of one of its trajectories."""
        covariance, name, remarks = trajectory.covariance(t), self.identity.name, []
        if covariance is None and len(trajectory.covariance_t):
            remarks.append(f"covariances of {name} are of other times")
        if covariance is not None and trajectory.remark:
            remarks.append(f"covariance of {name} {trajectory.remark}")
        widest = np.nan if covariance is None else float(np.sqrt(np.diag(covariance)[:3].max()))
        if widest > _WIDE:
            remarks.append(f"{name} known to {widest / 1e3:.0f} km")
        if widest < _EXACT:
            remarks.append(f"{name} known to {1e3 * widest:.0f} mm")
        if self.elements_t is not None and abs(days := (t - self.elements_t) / DAY) > WARN_DAYS:
            remarks.append(f"elements of {name} {abs(days):.0f} d {'old' if days > 0 else 'ahead'}")
        density = trajectory.density.at(t) if trajectory.density and covariance is not None else None
        state = trajectory.path.at(np.array([t]))[0]
        return Participant(self.identity, state, covariance, tuple(remarks), density)

    def unknown(self, wanted: Sequence[Span]) -> list[Span]:
        """Return those parts of spans, longer than a minute, that no trajectory covers."""
        return [
            (begin, end)
            for span in wanted
            for begin, end in _uncovered(span, sorted(trajectory.span for trajectory in self.trajectories))
            if end - begin > approaches.STEP
        ]


def read(paths: Sequence[FilePath]) -> list[ScreenedObject]:
    """Read the ephemerides in files, ours first: OEM, and mean elements over the span of ours.

    A file that is named twice counts once. The first file is of our object. Where it has mean elements,
    all of them fly over the span of the OEM. Of an object with several sets the newest before the middle
    of the span flies, by SGP4, to 30 days from its epoch at most. Raises InputError, naming the file, for
    what cannot be read, a first file of several objects, and where no file is an OEM.
    """
    for path in paths:
        if cdm.matches(contents(path)):
            raise InputError(f"{path}: expected an ephemeris or mean elements, got a CDM: it is read alone")
    first, *rest = {File(path).resolve(): path for path in paths}.values()
    ours = _of_message(first) if _is_message(first) else []
    messages = [path for path in rest if _is_message(path)]
    others = [ephemeris for path in messages for ephemeris in _of_message(path)]
    if not (
        spans := [trajectory.span for ephemeris in ours or others for trajectory in ephemeris.trajectories]
    ):
        raise InputError(f"{first}: expected an OEM among the files, got none")
    span = min(begin for begin, _ in spans), max(end for _, end in spans)
    ours = ours or _of_elements([first], span)
    if len(ours) > 1:
        raise InputError(f"{first}: expected one object, ours, got {ours[0].identity}, {ours[1].identity}")
    if not ours[0].trajectories:
        begin, end = _texts(span)
        raise InputError(f"{first}: expected elements that fly from {begin} to {end}, got others")
    elements = [path for path in rest if path not in messages]
    return [*ours, *others, *(_of_elements(elements, span) if elements else [])]


def screen(ephemerides: Sequence[ScreenedObject], *, within: float, radius: float) -> list[Conjunction]:
    """Return the close approaches of the first ephemeris's object and all others, in the order of time.

    within: largest distance [m]
    radius: sum of the radii of two objects [m]

    An object does not meet itself. Raises InputError for a distance or a radius that is none, and where no
    other object shares time with the first.
    """
    check_length("within", within)
    check_radius(radius)
    ours, *rest = ephemerides
    others = [one for one in rest if not one.identity.is_same(ours.identity)]
    for one in rest:
        if one not in others:
            _log.warning("%s: %s is ours itself", one.source, one.identity)
    if not others:
        raise InputError(
            f"conjunctions: expected ephemerides of another object than {ours.identity}, got none"
        )
    spans = [trajectory.span for trajectory in ours.trajectories]
    whole = min(begin for begin, _ in spans), max(end for _, end in spans)
    _tell_unknown(ours, [whole])
    for one in others:
        _tell_unknown(one, spans)
    if not any(_met_spans(ours, one) for one in others):
        begin, end = _texts(whole)
        raise InputError(f"conjunctions: expected another ephemeris from {begin} to {end}, got none")
    found = [
        conjunction for one in others for conjunction in _told_once(_conjunctions(ours, one, within, radius))
    ]
    return sorted(found, key=lambda conjunction: conjunction.t)


def _is_message(path: FilePath) -> bool:
    return oem.matches(contents(path))


def _tell_unknown(ephemeris: ScreenedObject, wanted: Sequence[Span]) -> None:
    """Log the spans of which an ephemeris knows nothing."""
    if not (unknown := ephemeris.unknown(wanted)):
        return
    begin, end = _texts(unknown[0])
    more = f", and {len(unknown) - 1} times more" if len(unknown) > 1 else ""
    epoch = ephemeris.elements_t
    why = "" if epoch is None else f": its elements are of {_texts((epoch, epoch))[0]}"
    _log.warning("%s: unknown from %s to %s%s%s", ephemeris.identity, begin, end, more, why)


def _texts(span: Span) -> tuple[str, str]:
    begin, end = ccsds.utc_texts(EPOCH, np.array(span))
    return begin[:_SECONDS], end[:_SECONDS]


def _uncovered(span: Span, covered: Sequence[Span]) -> Iterator[Span]:
    """Yield the parts of a span beside those that are covered, which stand in the order of time."""
    reached, end = span
    for begin, until in covered:
        if begin > reached:
            yield reached, min(begin, end)
        reached = max(reached, until)
    yield reached, end


def _met_spans(ours: ScreenedObject, other: ScreenedObject) -> list[Span]:
    """Return the times that trajectories of both share."""
    pairs = [
        approaches.shared(one.path, another.path)
        for one, another in product(ours.trajectories, other.trajectories)
    ]
    return [(begin, end) for begin, end in pairs if begin < end]


def _conjunctions(
    ours: ScreenedObject, other: ScreenedObject, within: float, radius: float
) -> Iterator[Conjunction]:
    """Yield the close approaches of two objects."""
    spans, known = _met_spans(ours, other), max(ours.known, other.known)
    for one, another in product(ours.trajectories, other.trajectories):
        for approach in approaches.find(one.path, another.path, within=within):
            if not _goes_on(approach, approaches.shared(one.path, another.path), spans):
                pair = ours.participant(one, approach.t), other.participant(another, approach.t)
                yield Conjunction(approach.t, *pair, radius, approach.is_end, known)


def _told_once(conjunctions: Iterable[Conjunction]) -> list[Conjunction]:
    """Return conjunctions of two objects without those that segments of the same states tell again."""
    told: list[Conjunction] = []
    for one in conjunctions:
        if not any(one.is_again(before) for before in told):
            told.append(one)
    return told


def _goes_on(approach: Approach, span: Span, spans: Sequence[Span]) -> bool:
    """Return whether an approach at the end of a span is looked at further in another."""
    is_last = approach.is_end and approach.t == span[1]
    return is_last and any(begin <= approach.t < end for begin, end in spans)


def _of_message(path: FilePath) -> list[ScreenedObject]:
    """Return an ephemeris of each object of an OEM."""
    segments = oem.read(path, epoch=EPOCH)
    try:
        flown = [(one.identity, _of_segment(one)) for one in segments]
    except InputError as reason:
        raise InputError(f"{path}: {reason}") from None
    source, known = File(path).name, segments[0].newest
    return [
        ScreenedObject(identity, source, [one for owner, one in flown if owner == identity], known)
        for identity in dict.fromkeys(identity for identity, _ in flown)
    ]


def _of_segment(segment: oem.Segment) -> Trajectory:
    path = Path(segment.name, segment.t, segment.states)
    covariances = segment.covariances
    if segment.covariance_frame == "GCRF" and len(covariances):
        turns = np.kron(np.eye(2), rsw_rotation(path.at(segment.covariance_t)))
        covariances = turns @ covariances @ turns.transpose(0, 2, 1)
    return Trajectory(path, segment.covariance_t, covariances, density=segment.density)


def _of_elements(paths: Sequence[FilePath], span: Span) -> list[ScreenedObject]:
    """Return an ephemeris over a span of each object that files have mean elements of."""
    history = histories.read(paths, epoch=EPOCH)
    flown = []
    for number, sets in history.sets.groupby("number"):
        known = histories.newest_before(sets.reset_index(drop=True), 0.5 * (span[0] + span[1]))
        row = sets.iloc[0 if known is None else known]
        identity = history.objects[number]
        known_t = float(np.fmax(row["t"], row["t_created"]))
        way = _flown(identity.name, row, span)
        flown.append(ScreenedObject(identity, row["file"], way, known_t, row["t"]))
    return flown


def _flown(name: str, row: pd.Series, span: Span) -> list[Trajectory]:
    """Return the trajectory of mean elements in a span, none where they are too old or decay before.

    SGP4 may go on after a failure or below the ground, for an object that has decayed.
    """
    most = DAY * MOST_DAYS
    begin, end = max(span[0], row["t"] - most), min(span[1] + approaches.STEP, row["t"] + most)
    t = np.arange(min(begin, row["t"]), max(end, row["t"]), approaches.STEP)
    states = histories.states_of(row, epoch=EPOCH, t=t)
    decayed, epoch = ~(np.linalg.norm(states[:, :3], axis=1) > _LOWEST), np.searchsorted(t, row["t"])
    first, last = np.flatnonzero(decayed[:epoch]), epoch + np.flatnonzero(decayed[epoch:])
    flown = slice(first[-1] + 1 if len(first) else 0, last[0] if len(last) else len(t))
    t, states = t[flown], states[flown]
    wanted = (t >= begin) & (t < end)
    if wanted.sum() < approaches.FEWEST:
        return []
    path = Path(name, t[wanted], _led(t[wanted], states[wanted]))
    return [_with_usual_errors(row, path)]


def _led(t: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Return states whose velocities lead from one to the next: in a steep descent those of SGP4 do not."""
    if np.linalg.norm(states[:, :3], axis=1).min() > _STEEP:
        return states
    return np.hstack([states[:, :3], approaches.velocities_of(t, states[:, :3])])


def _with_usual_errors(row: pd.Series, path: Path) -> Trajectory:
    """Return the trajectory with the covariances that sets of such orbits usually have, or none."""
    satellite = histories.satellite(row, epoch=EPOCH)
    days = (path.t - row["t"]) / DAY
    told = np.flatnonzero(np.abs(days) <= usual_errors.LONGEST)[::_SPARSE]
    if not (len(told) and usual_errors.are_known(satellite)):
        return Trajectory(path)
    t, states, days = path.t[told], path.states[told], np.abs(days[told])
    sigmas = usual_errors.expected(satellite, days)
    density = usual_errors.density_errors(satellite, t, states, days, sigmas)
    return Trajectory(path, t, usual_errors.covariances(sigmas, states), USUAL, density)
