"""The orbits inside the sets of a catalogue at their epochs.

Each is a measurement of where its object was, which judges what was predicted from older sets.
"""

from collections.abc import Sequence

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
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.element_set import seconds_since
from opml.tables import STATE

_BATCH = 256  # sets at a time, of the same days, so that few lanes of a block idle


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
    t, table = seconds_since(forces.epoch, catalogue.satellites), catalogue.table
    known = t + DAY * (table["known"] - table["t"]).to_numpy()
    first = np.where(np.isnan(ballistic), first_drag(table["bstar"].to_numpy()), ballistic)
    light = np.broadcast_to(reflection, len(t))
    rows = pd.DataFrame(np.nan, index=table.index, columns=[*STATE, "ballistic"])
    order = np.argsort(t, kind="stable")
    for members in (order[k : k + _BATCH] for k in range(0, len(order), _BATCH)):
        begins = [
            begin_at(
                KnownSet(float(t[k]), float(known[k]), catalogue.satellites[k]),
                forces.epoch,
                float(first[k]),
                float(light[k]),
            )
            for k in members
        ]
        unknown = np.flatnonzero(np.isnan(ballistic[members]))
        if len(unknown):
            own, guessed = members[unknown], [begins[k] for k in unknown]
            for k, begin in zip(unknown, gauged(forces, guessed, t[own], spans[own]), strict=True):
                begins[k] = begin
        solved = _solved(forces, begins, t[members], spans[members])
        rows.loc[members, "ballistic"] = [orbit.ballistic(numbers) for orbit, numbers in solved]
        again = [orbit.begin_again(numbers) for orbit, numbers in solved]
        rows.loc[members, [*STATE]] = _at_epochs(forces, again, t[members])
    return rows


def gauged(
    forces: Forces, begins: Sequence[Beginning], t: np.ndarray, spans: np.ndarray
) -> Sequence[Beginning]:
    """Return where orbits inside sets begin under a smooth field, NaN without any; t, spans: of `_solved`."""
    for _ in range(2):
        begins = [orbit.begin_again(numbers) for orbit, numbers in _solved(forces.smoothed, begins, t, spans)]
    return begins


def _solved(
    forces: Forces, begins: Sequence[Beginning], t: np.ndarray, spans: np.ndarray
) -> list[tuple[NearbyOrbit, np.ndarray]]:
    """Return orbits near sets of epochs t (sets,) and the changes of their numbers, NaN without any."""
    orbits = orbits_beside(forces, begins, back=spans[:, 0] + EVERY, ahead=spans[:, 1] + EVERY)
    solved = []
    for at, (before, after), orbit in zip(t, spans, orbits, strict=True):
        equations = orbit.equations(orbit.beginning.satellite)
        try:
            numbers = solve(orbit, [equations.over(at - before, at + after)])
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
