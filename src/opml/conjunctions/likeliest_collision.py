"""The likeliest collision of two objects, and the distribution of their relative state about it.

An error of kilometres along an orbit follows its curve: it is normal in equinoctial elements, and not in
positions. So the elements are looked for with which both objects collide, and which are likelier than all
others that do. About these their motion is linear in the elements, and the relative state is normal, as far
as a collision is concerned: that is Hall's 2D-Nc, for the time that is likeliest, and 3D-Nc, for each time.

An error of the air's density carries both objects along their tracks at once. Their covariances hold it, and
with what both share of it the errors of both are normal together (Casali et al. 2018).

Each object's elements are those in the RSW axes of its own state, where the inclination is none. That there
are spheres around the objects enlarges where they meet.

Sources: Hall 2021, Expected collision rates for tracked satellites, J. Spacecr. Rockets 58; Hall, Baars &
Casali 2023, A multistep probability of collision computational algorithm (AAS 23-398); Casali et al. 2018,
Effect of cross-correlation of orbital error on probability of collision determination (AAS 18-272).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from opml.base.constants import EARTH_GM
from opml.orbits.elements import rsw_rotation
from opml.orbits.equinoctial import cartesian_from_equinoctial, equinoctial_from_cartesian

_SIGN = np.array([-1.0, 1.0])  # of the first and the second object in what is relative
_STEP = 1e-5  # of the differences that tell how states change with the elements
_ROUNDS = 30  # at most, to the likeliest elements
_FAR, _FAR_ROUNDS = 1500.0, 6  # squared distance with no probability, rounds after which it stays so
_SETTLED = 1e-3  # change of the squared distance in standard deviations that ends them
STEADY = 0.02  # share of a velocity that its standard deviation may be
_STANDSTILL = 1e-6  # relative speed below which objects do not pass each other [m/s]
_FARTHEST = 0.5  # change of an element, as a share of what lacks an eccentricity of 1


@dataclass(frozen=True, eq=False)
class Cloud:
    """Distribution of a relative state."""

    mean: np.ndarray  # (..., 6) [m, m/s]
    covariance: np.ndarray  # (..., 6, 6)

    def __getitem__(self, which: Any) -> "Cloud":
        return Cloud(self.mean[which], self.covariance[which])


@dataclass(frozen=True, eq=False)
class UncertainPairs:
    """Pairs of objects on ellipses, at one time.

    common: (..., 2, 6) what one standard deviation of an error that both share does to the states [m, m/s];
        the covariances hold it
    """

    states: np.ndarray  # (..., 2, 6) in GCRF [m, m/s]
    covariances: np.ndarray  # (..., 2, 6, 6) of them
    radius: np.ndarray  # (...) sum of the radii [m]
    common: np.ndarray | None = None

    def distances(self, t: np.ndarray) -> np.ndarray:
        """Return the expected distances (n,) at times (n,) [s] of a pair [m]."""
        elements = np.broadcast_to(self._elements, (*t.shape, 2, 6))
        states = cartesian_from_equinoctial(elements, t[:, None], EARTH_GM)[:, :, None] @ self._axes
        return np.asarray(np.linalg.norm(_SIGN @ states[:, :, 0, :3], axis=-1))

    def straight_meeting(self) -> float:
        """Return when a pair most likely collides [s], by its relative velocity now."""
        position, velocity = np.split(_SIGN @ self.states, 2)
        spread = self.covariances.sum(axis=0)[:3, :3] + self.radius**2 / 5.0 * np.eye(3)
        weighed = np.linalg.solve(spread, velocity)
        return -float(weighed @ position) / max(float(weighed @ velocity), np.finfo(float).tiny)

    def clouds(self, t: np.ndarray) -> tuple[Cloud, np.ndarray]:
        """Return the relative states at times (...) [s] about where both collide then, and how far that is.

        The latter are squared distances (...) in standard deviations. This is for 3D-Nc.
        """
        times = t.ravel()
        elements, squared = np.tile(self._elements, (len(times), 1, 1)), np.full(len(times), np.inf)
        clouds = Cloud(np.empty((len(times), 6)), np.empty((len(times), 6, 6)))
        # R^2 / 5 is the variance along each axis of a point drawn from a ball of radius R.
        sphere, sought = self.radius**2 / 5.0 * np.eye(3), np.arange(len(times))
        for k in range(_ROUNDS):
            cloud, mixed = self._about(elements[sought], times[sought])
            # Lagrange's multipliers of the condition that both are at one place.
            met = np.linalg.solve(cloud.covariance[:, :3, :3] + sphere, cloud.mean[:, :3, None])[..., 0]
            before, squared[sought] = squared[sought], np.sum(cloud.mean[:, :3] * met, axis=-1)
            clouds.mean[sought], clouds.covariance[sought] = cloud.mean, cloud.covariance
            elements[sought] = self._pulled(mixed, met)
            # Where nothing flows anyway, the elements may stay roughly known.
            is_far = (squared[sought] > _FAR) & (k >= _FAR_ROUNDS)
            if not len(sought := sought[~(_settled(squared[sought], before) | is_far)]):
                break
        shaped = Cloud(clouds.mean.reshape(*t.shape, 6), clouds.covariance.reshape(*t.shape, 6, 6))
        return shaped, squared.reshape(t.shape)

    def collisions(self) -> tuple[Cloud, np.ndarray, np.ndarray]:
        """Return where both most likely collide at any time on straight paths past each other: for 2D-Nc.

        That is the relative state, linear in the elements about there, the velocity (..., 3) with which they
        collide [m/s], and whether (...) it was found, and they collide with hardly any other velocity.
        """
        elements, t = self._elements, np.zeros(self.states.shape[:-2])
        velocity, before = _SIGN @ self.states[..., 3:], np.full(t.shape, np.inf)
        # R^2 / 4 is the variance along each axis of a point drawn from a disc of radius R.
        disc = (self.radius**2 / 4.0)[..., None, None] * np.eye(2)
        for _ in range(_ROUNDS):
            cloud, mixed = self._about(elements, t)
            # Only the plane across the relative velocity counts: along it they meet sooner or later.
            plane = np.linalg.svd(velocity[..., None, :])[2][..., 1:, :]
            across = np.swapaxes(plane, -1, -2)
            spread = plane @ cloud.covariance[..., :3, :3] @ across + disc
            force = across @ np.linalg.solve(spread, plane @ cloud.mean[..., :3, None])
            squared = np.sum(cloud.mean[..., :3] * force[..., 0], axis=-1)
            if (settled := _settled(squared, before)).all():
                break
            likeliest = cloud.mean - (cloud.covariance[..., :3] @ force)[..., 0]
            position, velocity = likeliest[..., :3], likeliest[..., 3:]
            speed = np.maximum(np.linalg.norm(velocity, axis=-1), _STANDSTILL)
            # To the closest approach of the likeliest paths, from where the next round is linear.
            t = t - np.sum(position * velocity, axis=-1) / speed**2
            elements, before = self._pulled(mixed, force[..., 0]), squared
        steady = self._unsteadiness(cloud) < STEADY * np.linalg.norm(velocity, axis=-1)
        return cloud, velocity, settled & steady

    def _unsteadiness(self, cloud: Cloud) -> np.ndarray:
        """Return the standard deviation (...) of the velocity with which both collide [m/s]."""
        position, velocity = np.split(cloud.covariance, 2, axis=-2)
        sphere = (self.radius**2 / 5.0)[..., None, None] * np.eye(3)
        explained = velocity[..., :3] @ np.linalg.solve(position[..., :3] + sphere, position[..., 3:])
        variance = np.trace(velocity[..., 3:] - explained, axis1=-2, axis2=-1)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    @cached_property
    def _axes(self) -> np.ndarray:
        """Axes (..., 2, 6, 6) of the elements, for states."""
        return np.asarray(np.kron(np.eye(2), rsw_rotation(self.states)))

    @cached_property
    def _elements(self) -> np.ndarray:
        turned = (self._axes @ self.states[..., None])[..., 0]
        return equinoctial_from_cartesian(turned, EARTH_GM)

    @cached_property
    def _inverse(self) -> np.ndarray:
        """Partial derivatives (..., 2, 6, 6) of the elements with respect to states in their axes."""
        _, slope = self._propagated(self._elements, np.zeros(self.states.shape[:-2]))
        return np.linalg.inv(self._axes @ slope)

    @cached_property
    def _spread(self) -> np.ndarray:
        """Covariances (..., 2, 6, 6) of the elements."""
        turned = self._axes @ self.covariances @ np.swapaxes(self._axes, -1, -2)
        return np.asarray(self._inverse @ _without_negative(turned) @ np.swapaxes(self._inverse, -1, -2))

    @cached_property
    def _shared(self) -> np.ndarray | None:
        """Covariances (..., 2, 6, 6) of each object's elements with those of the other, None without any."""
        if self.common is None:
            return None
        common = self._inverse @ (self._axes @ self.common[..., None])
        return np.asarray(common @ np.swapaxes(common[..., ::-1, :, :], -1, -2))

    def _propagated(self, elements: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the states (..., 2, 6) of elements at times (...) [s], and their slopes (..., 2, 6, 6)."""
        steps = _STEP * np.concatenate([np.zeros((1, 6)), np.eye(6), -np.eye(6)])
        states = cartesian_from_equinoctial(elements[..., None, :] + steps, t[..., None, None], EARTH_GM)
        states = states @ self._axes
        slope = (states[..., 1:7, :] - states[..., 7:, :]) / (2.0 * _STEP)
        return states[..., 0, :], np.swapaxes(slope, -1, -2)

    def _about(self, elements: np.ndarray, t: np.ndarray) -> tuple[Cloud, np.ndarray]:
        """Return the relative state, linear about elements, and how it varies with these (..., 2, 6, 6)."""
        states, slope = self._propagated(elements, t)
        expected = states + (slope @ (self._elements - elements)[..., None])[..., 0]
        turned = np.swapaxes(slope, -1, -2)
        mixed = self._spread @ turned
        if self._shared is not None:
            # What both share goes to and fro with both, and leaves their distance.
            mixed = mixed - self._shared @ turned[..., ::-1, :, :]
        return Cloud(_SIGN @ expected, np.sum(slope @ mixed, axis=-3)), mixed

    def _pulled(self, mixed: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Return the elements (..., 2, 6) that meet by a force (..., 3) on the relative position."""
        change = -_SIGN[:, None] * (mixed[..., :3] @ force[..., None, :, None])[..., 0]
        # A whole step of Newton's may leave the ellipses.
        room = _FARTHEST * (1.0 - np.linalg.norm(self._elements[..., 1:3], axis=-1, keepdims=True))
        largest = np.max(np.abs(change), axis=-1, keepdims=True)
        return np.asarray(self._elements + change * np.minimum(1.0, room / np.maximum(largest, room)))


def _without_negative(covariances: np.ndarray) -> np.ndarray:
    """Return covariances (..., n, n) without variances below zero in any direction, as rounded ones have."""
    variances = np.diagonal(covariances, axis1=-2, axis2=-1)
    sigma = np.sqrt(np.maximum(variances, np.finfo(float).tiny))
    scale = sigma[..., :, None] * sigma[..., None, :]
    along, axes = np.linalg.eigh(covariances / scale)
    mended = (axes * np.maximum(along, 0.0)[..., None, :]) @ np.swapaxes(axes, -1, -2)
    return np.asarray(scale * mended)


def _settled(squared: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return whether squared distances (...) in standard deviations are those of the round before."""
    return np.asarray(np.abs(squared - before) < _SETTLED * np.maximum(squared, 1.0))
