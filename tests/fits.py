"""Fits of tracks of a known orbit, how far they are off it, and estimates along one that nothing fitted."""

import numpy as np
import pandas as pd

from opml.catalog.associate import quarantine
from opml.catalog.fit import observations, start_states
from opml.orbits.elements import cartesian_from_coe
from opml.tables import PARAMETER_COVARIANCES, STATE


def fitted(propagator, orbit, rows, earth_orientation, stations, settings, *, seed=42):
    """The table of estimates of rows that stations measured of an orbit, and how far they are `off` [m]."""
    starts = start_states.perturbed(orbit, rows, rso=propagator.rso.name, settings=settings, seed=seed)
    measured = observations.Measured(rows, earth_orientation, stations)
    found = quarantine.estimate_all(propagator, starts, measured, settings=settings)
    return found.assign(off=distances(found, orbit))


def distances(found, orbit):
    """Distances (n,) [m] of estimates from the states of an orbit at their times."""
    true = orbit.set_index("t").loc[found["t"], STATE[:3]].to_numpy()
    return np.linalg.norm(found[STATE[:3]].to_numpy() - true, axis=1)


def without_noise(rows):
    """Tracks that have the true values."""
    return rows.assign(**{name.removesuffix("_true"): rows[name] for name in rows if name.endswith("_true")})


def on_orbit(t, gm, *, a=6.77e6, e=1e-3, ahead=0.0):
    """States (n, 6) at times t (n,) of a low orbit without a force but the central one; ahead [rad]."""
    coe = np.tile([a, e, 0.9, 0.3, 1.2, 0.0], (len(t), 1))
    coe[:, 5] = np.sqrt(gm / a**3) * np.asarray(t) + ahead
    return cartesian_from_coe(coe, gm)


def estimates_on(t, states, *, covariance=None, **columns):
    """The table of estimates with states (n, 6), from track 10 on, and one covariance (7, 7) for all."""
    covariance = np.eye(7) if covariance is None else covariance
    known = dict(zip(PARAMETER_COVARIANCES, covariance[np.tril_indices(7)], strict=True))
    table = pd.DataFrame({"track": 10 + np.arange(len(t)), "t": t, "converged": True})
    table[STATE] = states
    return table.assign(**known | columns)
