"""Objects that are screened, and their trajectories with covariances: by states, or by mean elements."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path as File

import numpy as np

from opml.base.constants import DAY, WGS84_A
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import approaches
from opml.conjunctions.conjunction import Participant, remarks_on
from opml.conjunctions.sieve import STEEP, Looks, Span, may_meet, states_in_teme
from opml.interop.element_sets import known_sets, mean_elements, sgp4_errors
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import ElementSet
from opml.interop.element_sets.mean_elements import MOST_DAYS, WARN_DAYS
from opml.interop.ephemeris import EPOCH, Ephemeris, velocities_of, with_velocities
from opml.interop.object_ids import ObjectId
from opml.orbits.state_polynomials import FEWEST

USUAL = "is typical of public sets at its height"
"""Remark on a covariance that does not come from the object's own past."""

_LOWEST = 1e-3 * WGS84_A + 80.0  # distance from the Earth's centre below which nothing orbits [km]
_SPARSE = 10  # states of a path from one of its covariances to the next


def of_states(ephemeris: Ephemeris) -> Ephemeris:
    """Return an ephemeris with velocities everywhere, and covariances in RSW; raise InputError as `check`."""
    whole = replace(ephemeris, states=with_velocities(ephemeris.t, ephemeris.states), remark="")
    whole.check()
    return whole.in_rsw()


def span_of_days(path: FilePath, days: float) -> Span:
    """Return the days from the newest set of mean elements in a file on [s].

    Raises InputError for a number of days that is none.
    """
    if not 0.0 < days <= MOST_DAYS:
        raise InputError(f"--days: expected a number above 0 and up to {MOST_DAYS:g}, got {days:g}")
    newest = max(history[-1].t for _, history in _histories([path]))
    return newest, newest + DAY * days


@dataclass(frozen=True, eq=False)
class ScreenedObject:
    """An object of a file.

    known: when the newest was known that it is made from [s]; states: in the order of the file
    """

    identity: ObjectId
    source: str  # name of the file
    known: float
    states: Sequence[Ephemeris] = ()

    @property
    def trajectories(self) -> Sequence[Ephemeris]:
        """Trajectories of the object."""
        return self.states

    @property
    def epoch(self) -> float | None:
        """Epoch of mean elements [s]; None for states."""
        return None

    def may_meet(self, looks: Sequence[Looks], within: float) -> bool:
        """Return whether the object may come within a distance [m] of ours; looks: at ours."""
        return True

    def participant(self, trajectory: Ephemeris, t: float) -> Participant:
        """Return the object at a time [s] of one of its trajectories."""
        matrix, name, remarks = trajectory.covariances_at(np.array([t]))[0], self.identity.name, []
        covariance = matrix if np.isfinite(matrix).all() else None
        if covariance is None and len(trajectory.covariance_t):
            remarks.append(f"covariances of {name} are of other times")
        if covariance is not None and trajectory.remark:
            remarks.append(f"covariance of {name} {trajectory.remark}")
        remarks += remarks_on(name, covariance)
        if self.epoch is not None and abs(days := (t - self.epoch) / DAY) > WARN_DAYS:
            remarks.append(f"elements of {name} {abs(days):.0f} d {'old' if days > 0 else 'ahead'}")
        density = trajectory.density.at(t) if trajectory.density and covariance is not None else None
        state = trajectory.at(np.array([t]))[0]
        return Participant(self.identity, state, covariance, tuple(remarks), density)

    def unknown(self, wanted: Sequence[Span]) -> list[Span]:
        """Return those parts of spans, longer than a minute, that no trajectory covers."""
        gaps = []
        for reached, end in wanted:
            for begin, until in [*sorted(one.span for one in self.trajectories), (np.inf, np.inf)]:
                gaps.append((reached, min(begin, end)))
                reached = max(reached, until)
        return [(begin, end) for begin, end in gaps if end - begin > approaches.STEP]


@dataclass(frozen=True, eq=False)
class ScreenedElements(ScreenedObject):
    """Mean elements, which SGP4 propagates, or whatever `propagate` is.

    propagate: returns trajectories, none where the object has decayed, or its elements are too old
    """

    known_set: KnownSet = field(kw_only=True)  # times since EPOCH
    span: Span = field(kw_only=True)  # in which the object is looked for [s]
    propagate: Callable[["ScreenedElements"], Sequence[Ephemeris]] = field(kw_only=True)

    @cached_property
    def trajectories(self) -> Sequence[Ephemeris]:
        """Trajectories of the object, propagated at first use."""
        return self.propagate(self)

    @property
    def epoch(self) -> float:
        """Epoch of the elements [s]."""
        return self.known_set.t

    @cached_property
    def life(self) -> Span | None:
        """First and last state about the span [s], every minute; None: too old, or decayed before.

        SGP4 may go on after a failure or below the ground, for an object that has decayed.
        """
        epoch, most = self.epoch, DAY * MOST_DAYS
        begin, end = max(self.span[0], epoch - most), min(self.span[1] + approaches.STEP, epoch + most)
        t = np.arange(min(begin, epoch), max(end, epoch), approaches.STEP)
        heights, before = (
            np.linalg.norm(states_in_teme(self.known_set, t)[:, :3], axis=1),
            np.searchsorted(t, epoch),
        )
        decayed = ~(heights > _LOWEST)
        first, last = np.flatnonzero(decayed[:before]), before + np.flatnonzero(decayed[before:])
        t = t[first[-1] + 1 if len(first) else 0 : last[0] if len(last) else len(t)]
        t = t[(t > begin - approaches.STEP) & (t < end)]
        return (t[0], t[-1]) if len(t) else None

    def may_meet(self, looks: Sequence[Looks], within: float) -> bool:
        """Return whether the object may come within a distance [m] of ours, or is unknown at times."""
        oldest = max(float(np.abs(t[[0, -1]] - self.epoch).max()) for t, _ in looks)
        return oldest > DAY * MOST_DAYS or any(may_meet(one, self.known_set, within) for one in looks)

    def by_sgp4(self) -> list[Ephemeris]:
        """Return the trajectory through all states of the life, none where these are too few."""
        if self.life is None:
            return []
        return self._through(np.arange(self.life[0], self.life[1] + 0.5 * approaches.STEP, approaches.STEP))

    def during(self, span: Span) -> list[Ephemeris]:
        """Return the trajectory in a part of the life [s], none where it has too few states."""
        if self.life is None:
            return []
        ends = np.array([self.span, self.life, span])
        begin, end = ends[:, 0].max(), ends[:, 1].min()
        return self._through(np.linspace(begin, end, int(np.ceil((end - begin) / approaches.STEP)) + 1))

    def _through(self, t: np.ndarray) -> list[Ephemeris]:
        """Return the trajectory through times (n,) [s], with the covariances that are usual, or none."""
        if len(t) < FEWEST:
            return []
        satellite = self.known_set.satellite
        states = mean_elements.states(satellite, epoch=EPOCH, t=t)
        if np.linalg.norm(states[:, :3], axis=1).min() <= 1e3 * STEEP:
            # In a steep descent SGP4's velocities do not lead from one position to the next.
            states = np.hstack([states[:, :3], velocities_of(t, states[:, :3])])
        path = Ephemeris(self.identity.name, t, states)
        path.check()
        rows = np.flatnonzero(np.abs(t - self.epoch) <= DAY * sgp4_errors.LONGEST)[::_SPARSE]
        if not (len(rows) and sgp4_errors.are_known(satellite)):
            return [path]
        t, states, errors = t[rows], states[rows], sgp4_errors.usual(satellite, self.epoch)
        covered = replace(
            path, covariance_t=t, covariances=errors.covariances(t, states), covariance_frame="RSW"
        )
        return [replace(covered, density=errors.density(t, states), remark=USUAL)]


def read_elements(paths: Sequence[FilePath], span: Span) -> list[ScreenedElements]:
    """Return the mean elements of each object in files that are propagated over a span.

    They are the newest that were known before the middle of the span, else the first.
    """
    middle = 0.5 * (span[0] + span[1])
    elements = []
    for newest, history in _histories(paths):
        past = [one for one in history if max(one.t, one.made) <= middle]
        chosen, source = (past or history[:1])[-1], File(newest.path).name
        known = max(chosen.t, chosen.made)
        elements.append(
            ScreenedElements(
                known_sets.identity(newest),
                source,
                known,
                known_set=chosen,
                span=span,
                propagate=ScreenedElements.by_sgp4,
            )
        )
    return elements


def _histories(paths: Sequence[FilePath]) -> Iterator[tuple[ElementSet, list[KnownSet]]]:
    """Yield the newest set of each object in files, and all its sets by epoch, times since EPOCH."""
    for history in known_sets.by_object(paths).values():
        yield history[-1], known_sets.since(EPOCH, history, latency=0.0)
