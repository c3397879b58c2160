"""The orbits inside the sets of a catalogue at their epochs.

Each is a measurement of where its object was, which judges what was predicted from older sets.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside.inside_forces import Forces
from opml.element_sets.inside.orbit_inside import (
    EVERY,
    LIGHT,
    NUMBERS,
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

_BATCH = 256  # sets at a time, of the same days, so that few lanes of a block idle
_GAUGED = 30.0  # days for which the Cd A/m of one set begins those of the others


def usual_spans(catalogue: ElementCatalogue) -> np.ndarray:
    """Return the spans (sets, 2) before and after the epochs [s] that are usual for the decay of the sets."""
    return np.array([2 * [usual_half_span(one)] for one in catalogue.satellites]).reshape(-1, 2)


def states(
    catalogue: ElementCatalogue,
    forces: Forces,
    ballistic: np.ndarray,
    spans: np.ndarray,
    reflection: np.ndarray | float = LIGHT,
) -> pd.DataFrame:
    """Return STATE (GCRF) of the orbits inside the sets of a catalogue at their epochs, and `ballistic`,
    their Cd A/m [m2/kg], by the rows of its table; NaN where there is no orbit.

    ballistic: (sets,) Cd A/m that each is sought from, as of the day before [m2/kg]; NaN where none is known
    spans: as of `usual_spans`; reflection: Cr A/m [m2/kg]
    """
    times = _Times.of(catalogue, forces, spans, np.broadcast_to(reflection, len(spans)))
    unknown = np.flatnonzero(np.isnan(ballistic))
    begin = ballistic.copy()
    if len(unknown):
        begin[unknown] = _gauged(times.take(unknown))
    rows = pd.DataFrame(np.nan, index=catalogue.table.index, columns=[*STATE, "ballistic"])
    for members in _batches(np.argsort(times.t, kind="stable")):
        solved = _solved([times.begin(row, begin[row]) for row in members], times, members)
        rows.loc[members, "ballistic"] = [orbit.ballistic(numbers) for orbit, numbers in solved]
        again = [orbit.begin_again(numbers) for orbit, numbers in solved]
        rows.loc[members, [*STATE]] = _at_epochs(forces, again, times.t[members])
    return rows


@dataclass(frozen=True, eq=False)
class _Times:
    """Sets of a catalogue under forces, their epochs and when they were known (sets,) [s].

    spans, reflection: of `states`
    """

    catalogue: ElementCatalogue
    forces: Forces
    t: np.ndarray
    known: np.ndarray
    spans: np.ndarray
    reflection: np.ndarray

    @classmethod
    def of(
        cls, catalogue: ElementCatalogue, forces: Forces, spans: np.ndarray, reflection: np.ndarray
    ) -> "_Times":
        t, table = seconds_since(forces.epoch, catalogue.satellites), catalogue.table
        known = t + DAY * (table["known"] - table["t"]).to_numpy()
        return cls(catalogue, forces, t, known, spans, reflection)

    def take(self, rows: np.ndarray) -> "_Times":
        """Return those of some rows."""
        return self.of(self.catalogue.take(rows), self.forces, self.spans[rows], self.reflection[rows])

    def begin(self, row: int, ballistic: float) -> Beginning:
        """Return where the orbit of a set begins to be sought."""
        return begin_at(
            self.catalogue.satellites[row],
            self.forces.epoch,
            set_epoch=float(self.t[row]),
            known=float(self.known[row]),
            ballistic=ballistic,
            reflection=float(self.reflection[row]),
        )


def _batches(rows: np.ndarray) -> Iterator[np.ndarray]:
    yield from (rows[k : k + _BATCH] for k in range(0, len(rows), _BATCH))


def _gauged(times: _Times) -> np.ndarray:
    """Return the Cd A/m (sets,) that each set's is sought from: that of one set of its object and month."""
    table, t = times.catalogue.table, times.t
    groups = table.groupby(["number", np.floor((table["t"] - table["t"].min()) / _GAUGED)]).ngroup()
    gauged = np.full(len(table), np.nan)
    first = np.array([group[len(group) // 2] for group in table.groupby(groups).indices.values()])
    first = first[np.argsort(t[first], kind="stable")]
    ballistic, smooth = first_drag(table["bstar"].to_numpy()), replace(times, forces=times.forces.smoothed)
    for members in _batches(first):
        begins = [times.begin(row, ballistic[row]) for row in members]
        for _ in range(2):
            solved = _solved(begins, smooth, members)
            begins = [orbit.begin_again(numbers) for orbit, numbers in solved]
        gauged[members] = [one.ballistic for one in begins]
    return pd.Series(gauged).groupby(groups.to_numpy()).transform("max").to_numpy()


def _solved(
    begins: list[Beginning], times: _Times, members: np.ndarray
) -> list[tuple[NearbyOrbit, np.ndarray]]:
    """Return orbits near sets (members,) and the changes of their numbers, NaN without a solution."""
    spans = times.spans[members]
    orbits = orbits_beside(times.forces, begins, back=spans[:, 0] + EVERY, ahead=spans[:, 1] + EVERY)
    solved = []
    for row, (before, after), orbit in zip(members, spans, orbits, strict=True):
        equations = orbit.equations(orbit.displacements(orbit.beginning.satellite))
        try:
            numbers = solve(orbit, [equations.over(times.t[row] - before, times.t[row] + after)])
        except NoOrbitError:
            numbers = np.full(NUMBERS, np.nan)
        solved.append((orbit, numbers))
    return solved


def _at_epochs(forces: Forces, begins: Sequence[Beginning], t: np.ndarray) -> np.ndarray:
    """Return the GCRF states (n, 6) [m, m/s] of orbits at the epochs of their sets (n,) [s]."""
    starts = np.array([one.t for one in begins])
    epochs = np.unique(np.concatenate([starts, t]))
    first, last = (np.searchsorted(epochs, times) for times in (starts, t))
    departures = departing(begins, forces, first=first, last=last)
    arcs = forces.propagate(epochs, departures)
    paths = [np.concatenate([one.state[None], arcs.path(k)]) for k, one in enumerate(begins)]
    return np.array([path[-1] for path in paths])
