"""Fits of tracks of a known orbit, and how far they are off it."""

import numpy as np

from opml.catalog.fit import estimation, observations, start_states
from opml.tables import STATE


def fitted(
    propagator,
    orbit,
    rows,
    earth_orientation,
    stations,
    settings,
    *,
    seed=42,
    estimate=estimation.estimate_all,
):
    """The table of estimates of rows that stations measured of an orbit, and how far they are `off` [m]."""
    starts = start_states.perturbed(orbit, rows, rso=propagator.rso.name, settings=settings, seed=seed)
    measured = observations.Measured(rows, earth_orientation, stations)
    found = estimate(propagator, starts, measured, settings=settings)
    return found.assign(off=distances(found, orbit))


def distances(found, orbit):
    """Distances (n,) [m] of estimates from the states of an orbit at their times."""
    true = orbit.set_index("t").loc[found["t"], STATE[:3]].to_numpy()
    return np.linalg.norm(found[STATE[:3]].to_numpy() - true, axis=1)
