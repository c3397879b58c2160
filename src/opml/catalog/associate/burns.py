"""Burns between tracks: where the orbit of the later tracks meets that of the earlier ones.

Both orbits are propagated to every time between the tracks. Their difference (p, v) there has the covariance
C, the sum of both. Where the burn was, p is 0, and what is left of v is the burn:

    q = p' C_pp^-1 p
    dv = v - C_vp C_pp^-1 p,  covariance C_vv - C_vp C_pp^-1 C_pv

Of the times at which q is about the least, the one with the smallest burn is taken. Orbits that a burn
across the track parts meet twice a revolution, so there it may be half revolutions off.
"""

from dataclasses import dataclass

import numpy as np

from opml.catalog.associate.innovations import ReferenceOrbit
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.measurements import Window
from opml.catalog.fit.neighbour_arcs import NUDGES, propagate_around
from opml.orbits.elements import rsw_rotation

STEP = 20.0  # time between the epochs at which orbits are compared with each other [s]


_ALIKE = 9.0  # how much q may be above the least at times that are as good


@dataclass(frozen=True)
class TrackedBurn:
    """A burn that tracks show."""

    t: float  # [s]
    velocity: np.ndarray  # (3,) what it changed, in RSW [m/s]
    sigma: np.ndarray  # (3,) standard deviation of that
    mismatch: float  # distance of the two orbits then, in standard deviations


def burn_between(
    run: Run, before: ReferenceOrbit, after: ReferenceOrbit, span: tuple[float, float], scale: float
) -> TrackedBurn | None:
    """Return the burn that leads from an orbit before to one after; None where one of them is lost.

    span: from when to when it may have been [s]
    scale: factor on the standard deviations of both
    """
    t = np.linspace(*span, max(2, int((span[1] - span[0]) / STEP)))
    old, new = _propagated(run, before, t), _propagated(run, after, t)
    if old is None or new is None:
        return None
    difference = new[0] - old[0]
    covariance = scale**2 * (new[1] + old[1])
    place, both, speed = covariance[:, :3, :3], covariance[:, 3:, :3], covariance[:, 3:, 3:]
    gain = np.linalg.solve(place, both.transpose(0, 2, 1)).transpose(0, 2, 1)
    square = np.sum(difference[:, :3] * np.linalg.solve(place, difference[:, :3, None])[..., 0], axis=1)
    change = difference[:, 3:] - np.einsum("nij,nj->ni", gain, difference[:, :3])
    size = np.linalg.norm(change, axis=1)
    k = int(np.argmin(np.where(square <= square.min() + _ALIKE, size, np.inf)))
    axes = rsw_rotation(old[0][k])
    left = axes @ (speed[k] - gain[k] @ both[k].T) @ axes.T
    sigma = np.sqrt(np.diag(left))
    return TrackedBurn(float(t[k]), axes @ change[k], sigma, float(np.sqrt(square[k] / 3.0)))


def _propagated(run: Run, orbit: ReferenceOrbit, t: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return states (n, 6) of an orbit and their covariances (n, 6, 6); None if lost.

    t: (n,) times [s], all before the epoch of the orbit, or all after it
    """
    epoch = run.measured.epochs[orbit.at]
    at = 0 if epoch <= t[0] else len(t)
    window = Window(orbit.track, tracks=1, rows=slice(0, 0), first=0, at=at, last=len(t))
    epochs = np.insert(t, at, epoch)
    [around], [status] = propagate_around(run.propagator, epochs, [window], orbit.parameters[None])
    if status:
        return None
    states = np.delete(around.states, at, axis=1)
    partials = ((states[1:] - states[0]) / NUDGES[:, None, None]).transpose(1, 2, 0)
    covariance = orbit.later_covariance(run.propagator.rso.cd)
    return states[0], partials @ covariance @ partials.transpose(0, 2, 1)
