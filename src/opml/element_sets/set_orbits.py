"""What the orbits inside the sets of a catalogue tell of each set: how far SGP4 is off at its epoch and after
it.

At the epoch the orbit inside is a measurement of where the object was, of metres across and a few tens along:
it judges what was predicted from older sets. After it the orbit, under the density as it was forecast when
the set was published, is a prediction of its own, which SGP4's is compared with.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.dynamics.ensemble import propagate
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside_forces import Forces
from opml.element_sets.orbit_inside import (
    EVERY,
    LIGHT,
    NUMBERS,
    STEPS,
    Beginning,
    NearbyOrbit,
    NoOrbitError,
    begin_at,
    departing,
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
_BSTAR = 12.741621  # Cd A/m of a B* of 1/(6378.135 km), in SGP4's own density [m2/kg]
_LEAST = 3e-3  # Cd A/m from which one is sought first [m2/kg]
_BATCH = 256  # sets at a time, of the same days, so that few lanes of a block idle
_GAUGED = 30.0  # days for which the Cd A/m of one set begins those of the others


def build(catalogue: ElementCatalogue, forces: Forces) -> pd.DataFrame:
    """Return COLUMNS of the sets of a catalogue, by its rows; NaN where no orbit is found."""
    table = catalogue.table
    rows = pd.DataFrame(np.nan, index=table.index, columns=list(COLUMNS))
    t = seconds_since(forces.epoch, catalogue.satellites)
    known = t + DAY * (table["known"] - table["t"]).to_numpy()
    gauged = _gauged(catalogue, forces, t, known)
    for members in _batches(np.argsort(t, kind="stable")):
        begins = [_begin(catalogue, forces, t, known, row, gauged[row]) for row in members]
        solved = list(_solved(begins, forces, members, t, ahead=AHEAD))
        states = _at_epochs(forces, [orbit.begin_again(numbers) for _, orbit, numbers in solved], t[members])
        for state, (row, orbit, numbers) in zip(states, solved, strict=True):
            rows.loc[row] = [*state, orbit.ballistic(numbers), *_means(orbit, numbers, t[row])]
    return rows


def _batches(rows: np.ndarray) -> Iterator[np.ndarray]:
    yield from (rows[k : k + _BATCH] for k in range(0, len(rows), _BATCH))


def _begin(
    catalogue: ElementCatalogue,
    forces: Forces,
    t: np.ndarray,
    known: np.ndarray,
    row: int,
    ballistic: float,
) -> Beginning:
    return begin_at(
        catalogue.satellites[row],
        forces.epoch,
        set_epoch=float(t[row]),
        known=float(known[row]),
        ballistic=ballistic,
        reflection=LIGHT,
    )


def _gauged(catalogue: ElementCatalogue, forces: Forces, t: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return the Cd A/m (sets,) that each set's is sought from: that of one set of its object and month."""
    table = catalogue.table
    groups = table.groupby(["number", np.floor((table["t"] - table["t"].min()) / _GAUGED)]).ngroup()
    gauged = np.full(len(table), np.nan)
    first = np.array([group[len(group) // 2] for group in table.groupby(groups).indices.values()])
    first = first[np.argsort(t[first], kind="stable")]
    ballistic = np.maximum(_BSTAR * np.abs(table["bstar"].to_numpy()), _LEAST)
    for members in _batches(first):
        begins = [_begin(catalogue, forces, t, known, row, ballistic[row]) for row in members]
        for _ in range(2):
            done = list(_solved(begins, forces, members, t, ahead=0.0))
            begins = [orbit.begin_again(numbers) for _, orbit, numbers in done]
        gauged[members] = [one.ballistic for one in begins]
    return pd.Series(gauged).groupby(groups.to_numpy()).transform("max").to_numpy()


def _solved(
    begins: list[Beginning], forces: Forces, members: np.ndarray, t: np.ndarray, *, ahead: float
) -> Iterator[tuple[int, NearbyOrbit, np.ndarray]]:
    """Yield row, orbit beside and the changes of its numbers, NaN without a solution."""
    spans = np.array([usual_half_span(one.satellite) for one in begins])
    after = np.maximum(spans, DAY * ahead + _AROUND) + EVERY
    orbits = orbits_beside(forces, begins, back=spans + EVERY, ahead=after)
    for row, span, orbit in zip(members, spans, orbits, strict=True):
        equations = orbit.equations(orbit.displacements(orbit.beginning.satellite))
        try:
            numbers = solve(orbit, [equations.over(t[row] - span, t[row] + span)])
        except NoOrbitError:
            numbers = np.full(NUMBERS, np.nan)
        yield int(row), orbit, numbers


def _at_epochs(forces: Forces, begins: Sequence[Beginning], t: np.ndarray) -> np.ndarray:
    """Return the GCRF states (n, 6) [m, m/s] of orbits at the epochs of their sets (n,) [s]."""
    starts = np.array([one.t for one in begins])
    epochs = np.unique(np.concatenate([starts, t]))
    first, last = (np.searchsorted(epochs, times) for times in (starts, t))
    departures = departing(begins, forces, first=first, last=last)
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
