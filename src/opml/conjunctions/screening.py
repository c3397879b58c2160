"""Close approaches between ephemerides in files: orbits, with their covariances, and mean elements.

opml screen ours.oem others/*.oem catalogue.tle --within 5 --radius 20
opml screen catalogue.tle --days 7 --within 1

The second is of all objects of a catalogue. What is not compared with ours is logged: ephemerides of our own
object, and times that nothing is known of. Mean elements are propagated minute by minute where the sieve
finds that they may come near.
"""

import logging
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path as File

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import approaches, sieve
from opml.conjunctions.conjunction import Conjunction, check_length, check_radius
from opml.conjunctions.predicted_sets import predictor
from opml.conjunctions.sieve import Span
from opml.conjunctions.trajectories import ScreenedObject, of_states, read_elements, span_of_days
from opml.interop import ccsds, formats, known_orbits
from opml.interop.ephemeris import EPOCH, Ephemeris

RADIUS = 20.0  # sum of the radii of two objects by default [m]
DAYS = 7.0  # days that mean elements are propagated by default
WITHIN = 5.0  # distance that is near by default [km]

_REACH = 300.0  # time before and after a look in which two objects that may be near are propagated [s]
_SECONDS = len("2016-09-28T12:09:45")
_log = logging.getLogger(__name__)


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
    known_from = max([span[0], *(one.known for one in own[:1])])
    files = [*([] if ours else [first]), *elements]
    since = float(np.ceil(known_from - 1e-6))
    propagate = predictor(files, begin=since, end=span[1], weather=weather)
    ours = ours or [replace(one, propagate=propagate) for one in own]
    if len(ours) > 1:
        raise InputError(f"{first}: expected one object, ours, got {ours[0].identity}, {ours[1].identity}")
    if not ours[0].trajectories:
        begin, end = _texts(span)
        raise InputError(f"{first}: expected elements that SGP4 propagates from {begin} to {end}, got others")
    sets = read_elements(elements, span) if elements else []
    return [*ours, *others, *(replace(one, propagate=propagate) for one in sets)]


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
    looks = [sieve.looks_at(trajectory, epoch=EPOCH) for trajectory in ours.trajectories]
    near = [one for one in others if one.may_meet(looks, within)]
    for one in near:
        _tell_unknown(one, spans)
    if len(near) == len(others) and not any(_met_spans(ours.trajectories, one.trajectories) for one in near):
        begin, end = _texts(whole)
        raise InputError(f"conjunctions: expected another ephemeris from {begin} to {end}, got none")
    conjunctions = [
        conjunction
        for one in near
        for conjunction in _without_repetitions(
            approaches_of((ours, one), (ours.trajectories, one.trajectories), within, radius)
        )
    ]
    return sorted(conjunctions, key=lambda conjunction: conjunction.t)


def screen_all(path: FilePath, *, days: float, within: float, radius: float) -> Iterator[Conjunction]:
    """Yield the close approaches of all pairs of objects in a file of mean elements, in the order of time.

    days: from the newest set on
    within: largest distance [m]
    radius: sum of the radii of two objects [m]

    The newest set of each object is propagated by SGP4. Raises InputError for a file of fewer than two
    objects, and for a length that is none.
    """
    check_length("within", within)
    check_radius(radius)
    elements = read_elements([path], span_of_days(path, days))
    if len(elements) < 2:
        raise InputError(f"{path}: expected mean elements of two objects or more, got one")
    living = [(one, one.life) for one in elements if one.life is not None]
    known = sum(life[0] <= one.span[0] and life[1] >= one.span[1] for one, life in living)
    if known < len(elements):
        _log.warning("orbits unknown for a part of the time: %d of %d", len(elements) - known, len(elements))
    orbits = [(one.known_set, life) for one, life in living]
    for begin, end, pairs in sieve.near_pairs(orbits, elements[0].span, within):
        reach = begin - _REACH, end + _REACH
        both = ((living[k][0], living[n][0]) for k, n in pairs)
        near = [
            conjunction
            for one, other in both
            for conjunction in approaches_of(
                (one, other), (one.during(reach), other.during(reach)), within, radius
            )
            if begin <= conjunction.t < end
        ]
        yield from sorted(near, key=lambda conjunction: conjunction.t)


def _whole(spans: Iterable[Span]) -> Span:
    begins, ends = zip(*spans, strict=True)
    return min(begins), max(ends)


def _tell_unknown(ephemeris: ScreenedObject, wanted: Sequence[Span]) -> None:
    """Log the spans of which an ephemeris knows nothing."""
    if not (unknown := ephemeris.unknown(wanted)):
        return
    begin, end = _texts(unknown[0])
    more = f", and {len(unknown) - 1} times more" if len(unknown) > 1 else ""
    epoch = ephemeris.epoch
    why = "" if epoch is None else f": its elements are of {_texts((epoch, epoch))[0]}"
    _log.warning("%s: unknown from %s to %s%s%s", ephemeris.identity, begin, end, more, why)


def _texts(span: Span) -> tuple[str, str]:
    begin, end = ccsds.utc_texts(EPOCH, np.array(span))
    return begin[:_SECONDS], end[:_SECONDS]


def _met_spans(ours: Sequence[Ephemeris], others: Sequence[Ephemeris]) -> list[Span]:
    """Return the times that trajectories of two objects share."""
    pairs = [approaches.shared(one, another) for one, another in product(ours, others)]
    return [(begin, end) for begin, end in pairs if begin < end]


def approaches_of(
    pair: tuple[ScreenedObject, ScreenedObject],
    trajectories: tuple[Sequence[Ephemeris], Sequence[Ephemeris]],
    within: float,
    radius: float,
) -> Iterator[Conjunction]:
    """Yield the close approaches of two objects on their trajectories."""
    (ours, other), spans = pair, _met_spans(*trajectories)
    for one, another in product(*trajectories):
        last = approaches.shared(one, another)[1]
        for t, is_end in approaches.find(one, another, within=within):
            # An approach at the end of a span may be looked at further in another.
            if not (is_end and t == last and any(begin <= t < end for begin, end in spans)):
                both = ours.participant(one, t), other.participant(another, t)
                yield Conjunction(t, *both, radius, is_end, max(ours.known, other.known))


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
        ScreenedObject(identity, source, known, [one for owner, one in trajectories if owner == identity])
        for identity in dict.fromkeys(identity for identity, _ in trajectories)
    ]
