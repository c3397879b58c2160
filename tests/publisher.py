"""A publisher of element sets: SGP4 fitted to an orbit under full forces, on both sides of each epoch."""

from dataclasses import replace

import numpy as np
from support import EPOCH

from opml.base.constants import DAY, HOUR
from opml.element_sets.inside import inside_forces, orbit_inside
from opml.interop.element_sets import element_fits, element_set
from opml.interop.element_sets.burns_in_sets import KnownSet

HALF = 48.0 * HOUR
BALLISTIC, SUNLIT = 0.02, 0.03


def small_forces(weather="OBSERVED", *, first=57659.0, last=57676.0):
    """Forces with a small field about EPOCH."""
    return inside_forces.read(weather, first=first, last=last, degree=8)


def true_orbit(forces):
    """An orbit under these forces at 700 km, from 3 days before EPOCH to 24 days after it."""
    motion = 2.0 * np.pi / 98.7
    satellite = element_set.satellite(EPOCH, [motion, 1e-3, 1.7, 0.5, 1.0, 0.3, 1e-4])
    begin = begun(forces, satellite, day=0.0, ballistic=BALLISTIC, reflection=SUNLIT)
    [orbit] = orbit_inside.orbits_beside(
        forces, [begin], back=np.array([3.0 * DAY]), ahead=np.array([24.0 * DAY])
    )
    return orbit


def begun(forces, satellite, *, day, ballistic=0.01, reflection=SUNLIT):
    """Where the orbit of a set begins to be sought, under the weather of the truth."""
    t = forces.time(EPOCH) + DAY * day
    known = KnownSet(t, t + 30.0 * DAY, satellite)
    return orbit_inside.begin_at(known, forces.epoch, ballistic, reflection)


def burned(forces, truth, *, day, speed):
    """The orbit after a burn along the track [m/s], from three days before it as if it had always been so."""
    k = int(np.searchsorted(truth.t, forces.time(EPOCH) + DAY * day))
    state = truth.states[k] * np.repeat([1.0, 1.0 + speed / np.linalg.norm(truth.states[k, 3:])], 3)
    begin = replace(truth.beginning, t=truth.t[k], state=state)
    [orbit] = orbit_inside.orbits_beside(
        forces, [begin], back=np.array([3.0 * DAY]), ahead=np.array([(24.0 - day) * DAY])
    )
    return orbit


def published(forces, truth, day):
    """The set that a publisher makes of an orbit: SGP4 fitted to it over HALF on both sides."""
    at = forces.time(EPOCH) + DAY * day
    near = np.abs(truth.t - at) <= HALF
    positions, velocities = element_fits.in_teme(truth.states[near], forces.epoch, truth.t[near])
    centre = int(np.argmin(np.abs(truth.t[near] - at)))
    known = np.concatenate([positions[centre], velocities[centre]])
    return element_fits.fit(
        truth.t[near], positions, at=truth.t[near][centre], known=known, epoch=forces.epoch
    )
