"""The probability that two objects collide in a long encounter, in three dimensions.

While slow objects pass, the relative motion bends and the covariance changes. So probability flows, at any
time and from all sides, into the sphere of the sum of their radii, and its flow is summed over the time from
one least flow to the next, half a revolution to either side at most. What is in the sphere to begin with is
added. What flows at other times of the revolution, where the expected distance may have no minimum, is told
beside. Both objects fly by Kepler's laws about their closest approach, their deviations linearly. Who enters
twice counts twice.

Sources: Coppola 2012, Including velocity uncertainty in the probability of collision between space objects
(AAS 12-247); Hall 2021, Expected collision rates for tracked satellites, J. Spacecr. Rockets 58.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from opml.base.constants import EARTH_GM
from opml.conjunctions.probability import Chance, is_flat
from opml.orbits.elements import (
    cartesian_from_coe,
    coe_from_cartesian,
    mean_from_true_anomaly,
    true_from_mean_anomaly,
)

LEAST_SIGMA = 0.1
"""Least standard deviation of the relative position, as a share of the radius: narrower ones are widened."""

_PANELS = 32  # in half a revolution
_CLUSTERING = 3.0  # of the panels about the closest approach
_TIMES, _TIME_WEIGHTS = np.polynomial.legendre.leggauss(8)
_HEIGHTS, _HEIGHT_WEIGHTS = np.polynomial.legendre.leggauss(32)  # of points on a sphere
_FARTHEST = 12.0  # standard deviations from the sphere beyond which nothing flows into it
_STEPS = np.repeat([10.0, 0.01], 3)  # of the differences that tell how deviations grow [m, m/s]


@dataclass(frozen=True, eq=False)
class _Cloud:
    """Where a relative state may be at several times.

    mean: (n, 6) [m, m/s]
    covariance: (n, 6, 6)
    """

    mean: np.ndarray
    covariance: np.ndarray


def chance(states: np.ndarray, covariances: np.ndarray, radius: float, period: float) -> Chance:
    """Return how likely a collision is in a long encounter; the largest probability is not looked for.

    states: (2, 6) of both objects at their closest approach, on ellipses, in GCRF [m, m/s]
    covariances: (2, 6, 6) of them
    radius: sum of the radii [m]
    period: shortest time of a revolution [s]
    """
    before, after = (_summed(states, covariances, radius, 0.5 * period * share) for share in (-1.0, 1.0))
    inside = _inside(before.last, radius)
    probability = min(before.probability + after.probability + inside, 1.0)
    around = min(before.around + after.around + inside, 1.0)
    mended = is_flat(covariances.sum(axis=0)[:3, :3])
    return Chance(probability, math.nan, math.nan, mended, around)


@dataclass(frozen=True, eq=False)
class _Side:
    """What flows into the sphere before the closest approach, or after it.

    probability: of that, up to the least flow
    around: the same up to half a revolution away
    last: the relative state about the time of the least flow
    """

    probability: float
    around: float
    last: _Cloud


def _summed(states: np.ndarray, covariances: np.ndarray, radius: float, end: float) -> _Side:
    """Return what flows into the sphere from the closest approach to the least flow before `end` [s]."""
    edges = end * np.sinh(np.linspace(0.0, _CLUSTERING, _PANELS + 1)) / math.sinh(_CLUSTERING)
    steps, flows, clouds = np.diff(edges), np.empty(_PANELS), []
    for k, (begin, step) in enumerate(zip(edges[:-1], steps, strict=True)):
        cloud = _relative(states, covariances, begin + 0.5 * step * (1.0 + _TIMES))
        cloud = _widened(cloud, LEAST_SIGMA * radius)
        flows[k] = 0.5 * float(_TIME_WEIGHTS @ _flow(cloud, radius))
        clouds.append(cloud)
    # The least flow lies beyond the largest in the first quarter of a revolution.
    peak = int(np.argmax(np.where(edges[:-1] / end < 0.5, flows, 0.0)))
    least = peak + int(np.argmin(flows[peak:]))
    last = _Cloud(clouds[least].mean[-1:], clouds[least].covariance[-1:])
    summed = np.cumsum(np.abs(steps) * flows)
    return _Side(float(summed[least]), float(summed[-1]), last)


def _relative(states: np.ndarray, covariances: np.ndarray, t: np.ndarray) -> _Cloud:
    """Return where the second object may be relative to the first at times (n,) [s] about the approach."""
    first, second = (_flown(*one, t) for one in zip(states, covariances, strict=True))
    return _Cloud(second.mean - first.mean, first.covariance + second.covariance)


def _flown(state: np.ndarray, covariance: np.ndarray, t: np.ndarray) -> _Cloud:
    steps = np.diag(_STEPS)
    paths = kepler(np.concatenate([state[None], state + steps, state - steps]), t)
    growth = ((paths[:, 1:7] - paths[:, 7:]) / (2.0 * _STEPS[:, None])).transpose(0, 2, 1)
    return _Cloud(paths[:, 0], growth @ covariance @ growth.transpose(0, 2, 1))


def kepler(states: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the states (n, k, 6) of the ellipses through states (k, 6) at times (n,) [s] after them."""
    coe = coe_from_cartesian(states, EARTH_GM)
    a, e, nu = coe[:, 0], coe[:, 1], coe[:, 5]
    mean = mean_from_true_anomaly(nu, e) + np.sqrt(EARTH_GM / a**3) * t[:, None]
    later = np.repeat(coe[None], len(t), axis=0)
    later[..., 5] = true_from_mean_anomaly(mean, e)
    return cartesian_from_coe(later, EARTH_GM)


def _widened(cloud: _Cloud, least: float) -> _Cloud:
    """Return a cloud whose positions have no standard deviation below `least` [m]."""
    variances, axes = np.linalg.eigh(cloud.covariance[:, :3, :3])
    missing = np.maximum(least**2 - variances, 0.0)
    covariance = cloud.covariance.copy()
    covariance[:, :3, :3] += (axes * missing[:, None, :]) @ axes.transpose(0, 2, 1)
    return _Cloud(cloud.mean, covariance)


def _sphere() -> tuple[np.ndarray, np.ndarray]:
    """Return points (3, k) on the unit sphere, and their weights (k,), which sum up to its area."""
    angles = np.pi * (np.arange(2 * len(_HEIGHTS)) + 0.5) / len(_HEIGHTS)
    across = np.sqrt(1.0 - _HEIGHTS**2)
    x, y = np.outer(across, np.cos(angles)), np.outer(across, np.sin(angles))
    z, weights = (np.repeat(one, len(angles)) for one in (_HEIGHTS, _HEIGHT_WEIGHTS))
    return np.stack([x.ravel(), y.ravel(), z]), weights * np.pi / len(_HEIGHTS)


_POINTS, _AREAS = _sphere()


def _density(cloud: _Cloud, points: np.ndarray) -> np.ndarray:
    """Return the density (n, k) [1/m3] of positions at points (3, k) [m]."""
    lower = np.linalg.cholesky(cloud.covariance[:, :3, :3])
    scaled = np.linalg.solve(lower, points - cloud.mean[:, :3, None])
    volume = (2.0 * math.pi) ** 1.5 * np.prod(np.diagonal(lower, axis1=1, axis2=2), axis=1)
    density: np.ndarray = np.exp(-0.5 * np.sum(scaled**2, axis=1)) / volume[:, None]
    return density


def _flow(cloud: _Cloud, radius: float) -> np.ndarray:
    """Return the probability (n,) that flows into the sphere in a second."""
    flow = np.zeros(len(cloud.mean))
    sigmas = np.sqrt(np.linalg.eigvalsh(cloud.covariance[:, :3, :3])[:, 2])
    near = np.linalg.norm(cloud.mean[:, :3], axis=1) < radius + _FARTHEST * sigmas
    if near.any():
        cloud = _Cloud(cloud.mean[near], cloud.covariance[near])
        flow[near] = radius**2 * (_density(cloud, radius * _POINTS) * _inward(cloud, radius)) @ _AREAS
    return flow


def _inward(cloud: _Cloud, radius: float) -> np.ndarray:
    """Return the mean speed (n, k) [m/s] with which the points of the sphere are entered, 0 for leaving."""
    positions, mixed = cloud.covariance[:, :3, :3], cloud.covariance[:, 3:, :3]
    slope = np.linalg.solve(positions, mixed.transpose(0, 2, 1)).transpose(0, 2, 1)
    velocity = cloud.mean[:, 3:, None] + slope @ (radius * _POINTS - cloud.mean[:, :3, None])
    free = cloud.covariance[:, 3:, 3:] - slope @ mixed.transpose(0, 2, 1)
    speed = -np.sum(_POINTS * velocity, axis=1)
    sigma = np.sqrt(np.maximum(np.sum(_POINTS * (free @ _POINTS), axis=1), 1e-20))
    ratio = speed / sigma
    mean: np.ndarray = sigma * np.exp(-0.5 * ratio**2) / math.sqrt(2.0 * math.pi) + speed * ndtr(ratio)
    return mean


def _inside(cloud: _Cloud, radius: float) -> float:
    """Return the probability to be in the sphere at the one time of a cloud."""
    shells, weights = 0.5 * radius * (1.0 + _TIMES), 0.5 * radius * _TIME_WEIGHTS
    found = [float(_density(cloud, shell * _POINTS)[0] @ _AREAS) * shell**2 for shell in shells]
    return float(weights @ found)
