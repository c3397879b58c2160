"""Close approaches between ephemerides in files: orbits, with their covariances, and mean elements.

opml screen ours.oem others/*.oem catalogue.tle --within 5 --radius 20

What is not compared with ours is logged: ephemerides of our own object, and times that nothing is known of.
Mean elements are propagated minute by minute where the sieve finds that they may come near.
"""

import logging
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import product
from pathlib import Path as File

import numpy as np

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import approaches
from opml.conjunctions.conjunction import Conjunction, Participant, check_length, check_radius, remarks_on
from opml.conjunctions.predicted_sets import PredictedSets
from opml.conjunctions.sieve import Looks, Span
from opml.conjunctions.trajectories import (
    PropagatedElements,
    of_states,
    read_elements,
    span_of_days,
)
from opml.interop import ccsds, formats, known_orbits
from opml.interop.element_sets.mean_elements import WARN_DAYS
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.interop.object_ids import ObjectId

RADIUS = 20.0  # sum of the radii of two objects by default [m]
DAYS = 7.0  # days that mean elements are propagated by default
WITHIN = 5.0  # distance that is near by default [km]

_SECONDS = len("2016-09-28T12:09:45")
_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ScreenedObject:
    """An object of a file.

    propagate: return the trajectories, in the order of the file, none where the object has decayed, or its
        elements are too old
    """

    identity: ObjectId  # of the object
    source: str  # the file's name
    propagate: Callable[[], Sequence[Ephemeris]]
    known: float  # when the newest was known that it is made from [s]
    elements: PropagatedElements | None = None  # that are propagated; None for states

    @cached_property
    def trajectories(self) -> Sequence[Ephemeris]:
        """Trajectories of the object, propagated at first use."""
        return self.propagate()

    def participant(self, trajectory: Ephemeris, t: float) -> Participant:
        """Return the object at a time [s] of one of its trajectories."""
        matrix, name, remarks = trajectory.covariances_at(np.array([t]))[0], self.identity.name, []
        covariance = matrix if np.isfinite(matrix).all() else None
        if covariance is None and len(trajectory.covariance_t):
            remarks.append(f"covariances of {name} are of other times")
        if covariance is not None and trajectory.remark:
            remarks.append(f"covariance of {name} {trajectory.remark}")
        remarks += remarks_on(name, covariance)
        if self.elements is not None and abs(days := (t - self.elements.known_set.t) / DAY) > WARN_DAYS:
            remarks.append(f"elements of {name} {abs(days):.0f} d {'old' if days > 0 else 'ahead'}")
        density = trajectory.density.at(t) if trajectory.density and covariance is not None else None
        state = trajectory.at(np.array([t]))[0]
        return Participant(self.identity, state, covariance, tuple(remarks), density)

    def unknown(self, wanted: Sequence[Span]) -> list[Span]:
        """Return those parts of spans, longer than a minute, that no trajectory covers."""
        return [
            (begin, end)
            for span in wanted
            for begin, end in _uncovered(span, sorted(trajectory.span for trajectory in self.trajectories))
            if end - begin > approaches.STEP
        ]


def read(
    paths: Sequence[FilePath], *, days: float = DAYS, weather: FilePath = "OBSERVED"
) -> list[ScreenedObject]:
    """Read the ephemerides in files, ours first: orbits, and mean elements over the span of ours.

    days: from our newest set on that elements are propagated where no file is an orbit
    weather: OBSERVED, the packaged one, or a CSSI file, under which objects of several sets are predicted

    A file that is named twice counts once. The first file is of our object. Where it has mean elements,
    all of them are propagated over the span of the orbits. Over a week an object with several sets is where
    `opml predict` has it; any other is propagated by SGP4, the newest before the middle of the span, to 30
    days from its epoch at most. Raises InputError, naming the file, for what cannot be read, and a first file
    of several objects.
    """
    first, *rest = {File(path).resolve(): path for path in paths}.values()
    kinds = {path: formats.kind_of(path, formats.ORBIT, formats.ELEMENTS) for path in (first, *rest)}
    ours = _of_orbit(first) if kinds[first] == formats.ORBIT else []
    orbits = [path for path in rest if kinds[path] == formats.ORBIT]
    others = [ephemeris for path in orbits for ephemeris in _of_orbit(path)]
    spans = [trajectory.span for ephemeris in ours or others for trajectory in ephemeris.trajectories]
    span = _whole(spans) if spans else span_of_days(first, days)
    elements = [path for path in rest if path not in orbits]
    own = [] if ours else read_elements([first], span)
    known_from = max([span[0], *(one.time_known for one in own[:1])])
    files = [*([] if ours else [first]), *elements]
    predicted = PredictedSets(files, float(np.ceil(known_from - 1e-6)), span[1], weather)
    ours = ours or _of_elements(own, predicted)
    if len(ours) > 1:
        raise InputError(f"{first}: expected one object, ours, got {ours[0].identity}, {ours[1].identity}")
    if not ours[0].trajectories:
        begin, end = _texts(span)
        raise InputError(f"{first}: expected elements that SGP4 propagates from {begin} to {end}, got others")
    others += _of_elements(read_elements(elements, span), predicted) if elements else []
    return [*ours, *others]


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
        if one.identity.is_same(ours.identity):
            _log.warning("%s: %s is ours itself", one.source, one.identity)
    if not others:
        raise InputError(
            f"conjunctions: expected ephemerides of another object than {ours.identity}, got none"
        )
    spans = [trajectory.span for trajectory in ours.trajectories]
    whole = _whole(spans)
    _tell_unknown(ours, [whole])
    looks = [Looks.at(trajectory, epoch=EPOCH) for trajectory in ours.trajectories]
    near = [one for one in others if one.elements is None or one.elements.may_meet(looks, within)]
    for one in near:
        _tell_unknown(one, spans)
    if len(near) == len(others) and not any(_met_spans(ours, one) for one in near):
        begin, end = _texts(whole)
        raise InputError(f"conjunctions: expected another ephemeris from {begin} to {end}, got none")
    conjunctions = [
        conjunction
        for one in near
        for conjunction in _without_repetitions(approaches_of(ours, one, within, radius))
    ]
    return sorted(conjunctions, key=lambda conjunction: conjunction.t)


def _whole(spans: Iterable[Span]) -> Span:
    begins, ends = zip(*spans, strict=True)
    return min(begins), max(ends)


def _tell_unknown(ephemeris: ScreenedObject, wanted: Sequence[Span]) -> None:
    """Log the spans of which an ephemeris knows nothing."""
    if not (unknown := ephemeris.unknown(wanted)):
        return
    begin, end = _texts(unknown[0])
    more = f", and {len(unknown) - 1} times more" if len(unknown) > 1 else ""
    epoch = None if ephemeris.elements is None else ephemeris.elements.known_set.t
    why = "" if epoch is None else f": its elements are of {_texts((epoch, epoch))[0]}"
    _log.warning("%s: unknown from %s to %s%s%s", ephemeris.identity, begin, end, more, why)


def _texts(span: Span) -> tuple[str, str]:
    begin, end = ccsds.utc_texts(EPOCH, np.array(span))
    return begin[:_SECONDS], end[:_SECONDS]


def _uncovered(span: Span, covered: Sequence[Span]) -> Iterator[Span]:
    """Yield the parts of a span that are not covered by others, which stand in the order of time."""
    reached, end = span
    for begin, until in covered:
        if begin > reached:
            yield reached, min(begin, end)
        reached = max(reached, until)
    yield reached, end


def _met_spans(ours: ScreenedObject, other: ScreenedObject) -> list[Span]:
    """Return the times that trajectories of both share."""
    pairs = [
        approaches.shared(one, another) for one, another in product(ours.trajectories, other.trajectories)
    ]
    return [(begin, end) for begin, end in pairs if begin < end]


def approaches_of(
    ours: ScreenedObject, other: ScreenedObject, within: float, radius: float
) -> Iterator[Conjunction]:
    """Yield the close approaches of two objects."""
    spans, known = _met_spans(ours, other), max(ours.known, other.known)
    for one, another in product(ours.trajectories, other.trajectories):
        last = approaches.shared(one, another)[1]
        for t, is_end in approaches.find(one, another, within=within):
            # An approach at the end of a span may be looked at further in another.
            if not (is_end and t == last and any(begin <= t < end for begin, end in spans)):
                pair = ours.participant(one, t), other.participant(another, t)
                yield Conjunction(t, *pair, radius, is_end, known)


def _without_repetitions(conjunctions: Iterable[Conjunction]) -> list[Conjunction]:
    """Return conjunctions of two objects without those that segments of the same states repeat."""
    kept: list[Conjunction] = []
    for one in conjunctions:
        if not any(one.is_again(before) for before in kept):
            kept.append(one)
    return kept


def _of_orbit(path: FilePath) -> list[ScreenedObject]:
    """Return an ephemeris of each object in a file."""
    segments = known_orbits.segments(path, epoch=EPOCH)
    try:
        trajectories = [(one.identity, of_states(one)) for one in segments]
    except InputError as reason:
        raise InputError(f"{path}: {reason}") from None
    source, known = File(path).name, segments[0].newest
    return [
        ScreenedObject(
            identity, source, partial(list, [one for owner, one in trajectories if owner == identity]), known
        )
        for identity in dict.fromkeys(identity for identity, _ in trajectories)
    ]


def _of_elements(elements: Sequence[PropagatedElements], predicted: PredictedSets) -> list[ScreenedObject]:
    return [object_of_elements(one, partial(predicted.trajectories, one)) for one in elements]


def object_of_elements(
    elements: PropagatedElements, propagate: Callable[[], Sequence[Ephemeris]]
) -> ScreenedObject:
    """Return the object of mean elements; propagate: as that of `ScreenedObject`."""
    return ScreenedObject(elements.identity, elements.source, propagate, elements.time_known, elements)
