"""What the orbits inside the sets of a catalogue tell of each set: how far SGP4 is off at its epoch and after
it.

At the epoch the orbit inside is a measurement of where the object was, of metres across and a few tens along:
it judges what was predicted from older sets. After it the orbit, under the density as it was forecast when
the set was published, is a prediction of its own, which SGP4's is compared with.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.dynamics.ensemble import propagate
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside.inside_forces import Forces
from opml.element_sets.inside.orbit_inside import (
    EVERY,
    LIGHT,
    NUMBERS,
    STEPS,
    Beginning,
    NearbyOrbit,
    NoOrbitError,
    begin_at,
    departing,
    first_drag,
    orbits_beside,
    solve,
    usual_half_span,
)
from opml.interop.element_sets.element_set import seconds_since
from opml.tables import STATE

AHEAD = 8  # days after a set's epoch that its orbit is compared with SGP4: seven, and the age of a set

MEANS = tuple(f"ahead_{day}" for day in range(AHEAD + 1))
"""How far SGP4 is ahead of the orbit so many days after the epoch of the set, the mean of some revolutions
[m].
"""

COLUMNS = (*STATE, "ballistic", *MEANS)
"""GCRF state of the orbit inside at the set's epoch [m, m/s], its Cd A/m [m2/kg], and MEANS."""

_AROUND = 4.5 * HOUR  # a mean is that of a parabola through so much before and after [s]
_BATCH = 256  # sets at a time, of the same days, so that few lanes of a block idle
_GAUGED = 30.0  # days for which the Cd A/m of one set begins those of the others


def build(catalogue: ElementCatalogue, forces: Forces) -> pd.DataFrame:
    """Return COLUMNS of the sets of a catalogue, by its rows; NaN where no orbit is found."""
    times = _Times.of(catalogue, forces)
    rows = pd.DataFrame(np.nan, index=catalogue.table.index, columns=list(COLUMNS))
    for row, state, orbit, numbers in _orbits(times, _gauged(times), ahead=AHEAD):
        rows.loc[row] = [*state, orbit.ballistic(numbers), *_means(orbit, numbers, times.t[row])]
    return rows


def states(catalogue: ElementCatalogue, forces: Forces, ballistic: np.ndarray) -> pd.DataFrame:
    """Return STATE and ballistic as of COLUMNS.

    ballistic: (sets,) Cd A/m that each is sought from, as of the day before [m2/kg]; NaN where none is known
    """
    unknown = np.flatnonzero(np.isnan(ballistic))
    begin = ballistic.copy()
    if len(unknown):
        begin[unknown] = _gauged(_Times.of(catalogue.take(unknown), forces))
    rows = pd.DataFrame(np.nan, index=catalogue.table.index, columns=list(COLUMNS[: -len(MEANS)]))
    for row, state, orbit, numbers in _orbits(_Times.of(catalogue, forces), begin, ahead=0.0):
        rows.loc[row] = [*state, orbit.ballistic(numbers)]
    return rows


@dataclass(frozen=True, eq=False)
class _Times:
    """Sets of a catalogue under forces, their epochs and when they were known (sets,) [s]."""

    catalogue: ElementCatalogue
    forces: Forces
    t: np.ndarray
    known: np.ndarray

    @classmethod
    def of(cls, catalogue: ElementCatalogue, forces: Forces) -> "_Times":
        t, table = seconds_since(forces.epoch, catalogue.satellites), catalogue.table
        return cls(catalogue, forces, t, t + DAY * (table["known"] - table["t"]).to_numpy())

    def begin(self, row: int, ballistic: float) -> Beginning:
        """Return where the orbit of a set begins to be sought."""
        return begin_at(
            self.catalogue.satellites[row],
            self.forces.epoch,
            set_epoch=float(self.t[row]),
            known=float(self.known[row]),
            ballistic=ballistic,
            reflection=LIGHT,
        )


def _orbits(
    times: _Times, ballistic: np.ndarray, *, ahead: float
) -> Iterator[tuple[int, np.ndarray, NearbyOrbit, np.ndarray]]:
    """Yield the rows of sets with the states (6,) at their epochs, as of `_solved` in batches."""
    for members in _batches(np.argsort(times.t, kind="stable")):
        begins = [times.begin(row, ballistic[row]) for row in members]
        solved = list(_solved(begins, times, members, ahead=ahead))
        again = [orbit.begin_again(numbers) for _, orbit, numbers in solved]
        at_epochs = _at_epochs(times.forces, again, times.t[members])
        for state, (row, orbit, numbers) in zip(at_epochs, solved, strict=True):
            yield row, state, orbit, numbers


def _batches(rows: np.ndarray) -> Iterator[np.ndarray]:
    yield from (rows[k : k + _BATCH] for k in range(0, len(rows), _BATCH))


def _gauged(times: _Times) -> np.ndarray:
    """Return the Cd A/m (sets,) that each set's is sought from: that of one set of its object and month."""
    table, t = times.catalogue.table, times.t
    groups = table.groupby(["number", np.floor((table["t"] - table["t"].min()) / _GAUGED)]).ngroup()
    gauged = np.full(len(table), np.nan)
    first = np.array([group[len(group) // 2] for group in table.groupby(groups).indices.values()])
    first = first[np.argsort(t[first], kind="stable")]
    ballistic = first_drag(table["bstar"].to_numpy())
    for members in _batches(first):
        begins = [times.begin(row, ballistic[row]) for row in members]
        for _ in range(2):
            solved = _solved(begins, times, members, ahead=0.0)
            begins = [orbit.begin_again(numbers) for _, orbit, numbers in solved]
        gauged[members] = [one.ballistic for one in begins]
    return pd.Series(gauged).groupby(groups.to_numpy()).transform("max").to_numpy()


def _solved(
    begins: list[Beginning], times: _Times, members: np.ndarray, *, ahead: float
) -> Iterator[tuple[int, NearbyOrbit, np.ndarray]]:
    """Yield row, orbit near the set and the changes of its numbers, NaN without a solution.

    ahead: days after the epochs of the sets (members,) that the orbits reach at least
    """
    spans = np.array([usual_half_span(one.satellite) for one in begins])
    after = np.maximum(spans, DAY * ahead + _AROUND) + EVERY
    orbits = orbits_beside(times.forces, begins, back=spans + EVERY, ahead=after)
    for row, span, orbit in zip(members, spans, orbits, strict=True):
        equations = orbit.equations(orbit.displacements(orbit.beginning.satellite))
        try:
            numbers = solve(orbit, [equations.over(times.t[row] - span, times.t[row] + span)])
        except NoOrbitError:
            numbers = np.full(NUMBERS, np.nan)
        yield int(row), orbit, numbers


def _at_epochs(forces: Forces, begins: Sequence[Beginning], t: np.ndarray) -> np.ndarray:
    """Return the GCRF states (n, 6) [m, m/s] of orbits at the epochs of their sets (n,) [s]."""
    starts = np.array([one.t for one in begins])
    epochs = np.unique(np.concatenate([starts, t]))
    first, last = (np.searchsorted(epochs, times) for times in (starts, t))
    departures = departing(begins, forces.model, first=first, last=last)
    arcs = propagate(forces.model, epochs, departures, integrator=STEPS, threads=forces.threads)
    paths = [np.concatenate([one.state[None], arcs.path(k)]) for k, one in enumerate(begins)]
    return np.array([path[-1] for path in paths])


def _means(orbit: NearbyOrbit, numbers: np.ndarray, t: float) -> list[float]:
    """Return MEANS of a set with its epoch [s], NaN where SGP4 or the orbit ends."""
    off = orbit.displacements(orbit.beginning.satellite)[:, 1] - orbit.partials[:, 1] @ numbers
    means = []
    for day in range(AHEAD + 1):
        near = np.abs(orbit.t - t - DAY * day) <= _AROUND
        since = (orbit.t[near] - t - DAY * day) / DAY
        means.append(float(np.polynomial.polynomial.polyfit(since, off[near], 2)[0]))
    return means
