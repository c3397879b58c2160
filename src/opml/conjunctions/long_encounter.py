"""The probability that two objects collide in a long encounter, in three dimensions.

While slow objects pass, the relative motion bends and the covariance changes. So probability flows, at any
time and from all sides, into the sphere of the sum of their radii, and its flow is summed over the time from
one largest expected distance to the next. What is in the sphere to begin with is added. Where the flow has
not ended at such a limit, it belongs to the next encounter from the least flow on, and is separate. Both
objects are propagated by Kepler's laws, and at each time their deviations are linear in the elements about
where they most likely collide then. Who enters twice counts twice.

Sources: Coppola 2012, Including velocity uncertainty in the probability of collision between space objects
(AAS 12-247); Hall 2021, Expected collision rates for tracked satellites, J. Spacecr. Rockets 58.
"""

import math

import numpy as np
from scipy.special import ndtr

from opml.conjunctions.likeliest_collision import Cloud, UncertainPairs
from opml.conjunctions.probability import Chance, is_flat

LEAST_SIGMA = 0.1
"""Least standard deviation of the relative position, as a share of the radius: narrower ones are inflated."""

_PANELS = 32  # to either side, before they are halved
_HALVINGS = 16  # of a panel, at most
_MOST_PANELS = 400  # after that, where the likeliest collision jumps with time
_RESOLVED = 4.0  # change of the squared distance in a panel that is not halved
_TIMES, _TIME_WEIGHTS = np.polynomial.legendre.leggauss(8)
_HEIGHTS, _HEIGHT_WEIGHTS = np.polynomial.legendre.leggauss(32)  # of points on a sphere
_DIP = 3.0  # sum of both neighbours' distances, in those of one that may lie next to a collision
_BEYOND = 40.0  # squared distance above the least from which on nothing flows
_QUIET, _NOTABLE = 1e-6, 1e-3  # shares of the largest flow: an encounter has ended, one has been
_FALLEN = 0.5  # share of the largest flow before, at which it has fallen
_LOOKS = 221  # at the expected distance, within 1.1 revolutions to either side


def chance(pair: UncertainPairs, period: float) -> Chance:
    """Return how likely a collision of a pair is; the largest probability is not looked for.

    period: shortest time of a revolution [s]
    """
    flows, arounds, clouds = zip(*(_summed(pair, end) for end in _ends(pair, period)), strict=True)
    inside = _inside(clouds[0], float(pair.radius))
    probability, around = min(sum(flows) + inside, 1.0), min(sum(arounds) + inside, 1.0)
    mended = is_flat(pair.covariances.sum(axis=0)[:3, :3])
    return Chance(probability, math.nan, math.nan, mended, around)


def _ends(pair: UncertainPairs, period: float) -> tuple[float, float]:
    """Return when the objects are expected to be farthest before and after they meet [s].

    They meet at the closest approach, or where straight paths have the likeliest collision, and anywhere
    between. Where there are no such two times, it is half a revolution to either side (Hall 2021).
    """
    t = np.linspace(-1.1, 1.1, _LOOKS) * period
    distance = pair.distances(t)
    farthest = t[1:-1][(distance[1:-1] > distance[:-2]) & (distance[1:-1] >= distance[2:])]
    met = pair.straight_meeting()
    before, after = farthest[farthest < min(met, 0.0)], farthest[farthest > max(met, 0.0)]
    if not (len(before) and len(after)):
        return -0.5 * period, 0.5 * period
    return float(before[-1]), float(after[0])


def _summed(pair: UncertainPairs, end: float) -> tuple[float, float, Cloud]:
    """Return the probability that flows into the sphere from the closest approach to the encounter's end.

    end: when the objects are expected to be farthest [s]

    Then that up to the largest distance, and the relative state about the end.
    """
    edges = _edges(pair, end)
    begins, steps = edges[:-1], np.diff(edges)
    cloud, squared = pair.clouds(begins[:, None] + 0.5 * steps[:, None] * (1.0 + _TIMES))
    cloud, is_near = _widened(cloud, LEAST_SIGMA * float(pair.radius)), squared < squared.min() + _BEYOND
    flow, radius = np.zeros(is_near.shape), float(pair.radius)
    for k in np.flatnonzero(is_near.any(axis=1)):  # a panel fits into the processor's cache
        entering = _density(cloud[k], radius * _POINTS) * _inward(cloud[k], radius)
        flow[k] = radius**2 * entering @ _AREAS
    flows = 0.5 * flow @ _TIME_WEIGHTS
    least = _last(flows)
    summed = np.cumsum(np.abs(steps) * flows)
    return float(summed[least]), float(summed[-1]), cloud[least, -1:]


def _last(flows: np.ndarray) -> int:
    """Return the last panel of an encounter, whose flows (n,) go from the closest approach on.

    It is the last of all, but where the flow has fallen and risen again, and not ended.
    """
    highest = np.maximum.accumulate(flows)
    fallen = (flows < _FALLEN * highest) & (highest > _NOTABLE * highest[-1])
    if flows[-1] <= _QUIET * highest[-1] or not fallen.any():
        return len(flows) - 1
    return len(flows) - 1 - int(np.argmin(np.where(fallen, flows, np.inf)[::-1]))


def _edges(pair: UncertainPairs, end: float) -> np.ndarray:
    """Return limits of panels of time from 0 to `end` [s], which are halved where a collision is likely."""
    t = np.linspace(0.0, end, _PANELS + 1)
    squared = pair.clouds(t)[1]
    for _ in range(_HALVINGS):
        distance = np.pad(np.sqrt(np.maximum(squared, 0.0)), 1, mode="reflect")
        # About a collision the distance falls and rises in straight lines.
        may_dip = distance[:-2] + distance[2:] > _DIP * distance[1:-1]
        is_low = may_dip | (squared < squared.min() + _BEYOND)
        # A minimum between two equal values shows in the panels next to them.
        change = np.abs(np.diff(np.pad(squared, 1, mode="edge")))
        is_steep = np.maximum(np.maximum(change[:-2], change[2:]), change[1:-1]) > _RESOLVED
        halved = np.flatnonzero(is_steep & (is_low[:-1] | is_low[1:]))
        if not 0 < len(halved) <= _MOST_PANELS - len(t):
            break
        middles = 0.5 * (t[halved] + t[halved + 1])
        squared = np.insert(squared, halved + 1, pair.clouds(middles)[1])
        t = np.insert(t, halved + 1, middles)
    return t


def _widened(cloud: Cloud, least: float) -> Cloud:
    """Return a cloud whose positions have no standard deviation below `least` [m]."""
    variances, axes = np.linalg.eigh(cloud.covariance[..., :3, :3])
    missing = np.maximum(least**2 - variances, 0.0)
    covariance = cloud.covariance.copy()
    covariance[..., :3, :3] += (axes * missing[..., None, :]) @ np.swapaxes(axes, -1, -2)
    return Cloud(cloud.mean, covariance)


def _sphere() -> tuple[np.ndarray, np.ndarray]:
    """Return points (3, k) on the unit sphere, and their weights (k,), which sum up to its area."""
    angles = np.pi * (np.arange(2 * len(_HEIGHTS)) + 0.5) / len(_HEIGHTS)
    across = np.sqrt(1.0 - _HEIGHTS**2)
    x, y = np.outer(across, np.cos(angles)), np.outer(across, np.sin(angles))
    z, weights = (np.repeat(one, len(angles)) for one in (_HEIGHTS, _HEIGHT_WEIGHTS))
    return np.stack([x.ravel(), y.ravel(), z]), weights * np.pi / len(_HEIGHTS)


_POINTS, _AREAS = _sphere()


def _density(cloud: Cloud, points: np.ndarray) -> np.ndarray:
    """Return the density (n, k) [1/m3] of positions at points (3, k) [m]."""
    lower = np.linalg.cholesky(cloud.covariance[:, :3, :3])
    scaled = np.linalg.inv(lower) @ (points - cloud.mean[:, :3, None])
    volume = (2.0 * math.pi) ** 1.5 * np.prod(np.diagonal(lower, axis1=1, axis2=2), axis=1)
    return np.exp(-0.5 * np.sum(scaled**2, axis=1)) / volume[:, None]


def _inward(cloud: Cloud, radius: float) -> np.ndarray:
    """Return the mean speed (n, k) [m/s] with which the points of the sphere are entered, 0 for leaving."""
    positions, mixed = cloud.covariance[:, :3, :3], cloud.covariance[:, 3:, :3]
    # Given a position on the sphere, the velocity is normal about this mean with the covariance `free`.
    slope = np.linalg.solve(positions, mixed.transpose(0, 2, 1)).transpose(0, 2, 1)
    velocity = cloud.mean[:, 3:, None] + slope @ (radius * _POINTS - cloud.mean[:, :3, None])
    free = cloud.covariance[:, 3:, 3:] - slope @ mixed.transpose(0, 2, 1)
    speed = -np.sum(_POINTS * velocity, axis=1)
    sigma = np.sqrt(np.maximum(np.sum(_POINTS * (free @ _POINTS), axis=1), 1e-20))
    ratio = speed / sigma
    # The mean of max(speed, 0) of a normal speed.
    return sigma * np.exp(-0.5 * ratio**2) / math.sqrt(2.0 * math.pi) + speed * ndtr(ratio)


def _inside(cloud: Cloud, radius: float) -> float:
    """Return the probability to be in the sphere at the one time of a cloud."""
    shells, weights = 0.5 * radius * (1.0 + _TIMES), 0.5 * radius * _TIME_WEIGHTS
    flows = [float(_density(cloud, shell * _POINTS)[0] @ _AREAS) * shell**2 for shell in shells]
    return float(weights @ flows)
