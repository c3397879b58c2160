"""The probability that two objects collide in a short encounter, in two dimensions.

While two objects pass, the relative motion is a straight line and the covariance is constant. So they collide
where the relative position, projected on the plane across the relative velocity, lies in a circle with the
sum of their radii. In the principal axes of the covariance the probability of that is a single integral of
error functions.

The larger an uncertain covariance, the smaller the probability in the end: it is diluted. The largest
probability under any multiple of the covariance shows it.

Sources: Foster & Estes 1992, A parametric analysis of orbital debris collision probability (JSC 25898);
Alfano 2005, A numerical implementation of spherical object collision probability, J. Astronaut. Sci. 53;
Alfano 2005, Relating position uncertainty to maximum conjunction probability, J. Astronaut. Sci. 53;
Hall, Hejduk & Johnson 2017, Remediating non-positive definite state covariances for collision probability
estimation (AAS 17-567); Coppola 2012, Evaluating the short encounter assumption of the probability of
collision formula (AAS 12-248).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import ndtr

from opml.base.errors import InputError

SHORT = 0.02  # longest share of a revolution that a short encounter may last

LEAST_SIGMA = 1e-4
"""Least standard deviation in the plane, as a share of the radius: narrower ones are inflated to it."""

_EDGES = np.array([-40.0, -20.0, -10.0, -6.0, -4.0, -3.0, -2.0, -1.0, 0.0])
_EDGES = np.concatenate([_EDGES, -_EDGES[-2::-1]])
"""Limits of the panels of the integral, in standard deviations from the middle."""

_EIGHTHS = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 9)
"""Limits of panels [rad] that do not follow the distribution."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_SCALES = np.geomspace(1e-3, 1e3, 25)
"""Factors of the standard deviations among which the largest probability is looked for."""

_ROUNDING = 1e-14
_INSIDE = 5.73  # standard deviations along the relative velocity beyond which lies a part in 10^8


@dataclass(frozen=True)
class Encounter:
    """Two objects where they are closest.

    position, velocity: (3,) of the second relative to the first, in GCRF [m, m/s]
    """

    position: np.ndarray
    velocity: np.ndarray
    covariance: np.ndarray  # (3, 3) of the relative position, in GCRF [m2]
    radius: float  # sum of the radii of both [m]

    def __post_init__(self) -> None:
        """Raise InputError for no radius, and numbers that are none."""
        if not 0.0 < self.radius < math.inf:
            raise InputError(f"encounter: expected a radius above 0 m, got {self.radius:g}")
        if not (np.isfinite(self.position).all() and np.isfinite(self.covariance).all()):
            raise InputError("encounter: expected numbers for position and covariance, got others")

    @property
    def duration(self) -> float:
        """Time in which the objects may touch [s], by the uncertainty along their relative motion."""
        if not (speed := float(np.linalg.norm(self.velocity))) > 0.0:
            return math.inf
        ahead = self.velocity / speed
        spread = self.covariance + self.radius**2 / 5.0 * np.eye(3)
        weight = max(float(ahead @ np.linalg.solve(spread, ahead)), np.finfo(float).tiny)
        sigma = 1.0 / math.sqrt(weight)
        return 2.0 * (_INSIDE * sigma + self.radius) / speed


@dataclass(frozen=True)
class Chance:
    """The probability of a collision.

    scale: factor of the standard deviations at which it is reached; below 1 the probability is diluted
    around: the probability within half a revolution to either side, NaN for a short encounter
    """

    probability: float  # of a collision
    most: float  # largest probability under any multiple of the covariance, NaN for a long encounter
    scale: float
    mended: bool  # whether the covariance was none, or flat, and was inflated
    around: float = math.nan

    @property
    def is_diluted(self) -> bool:
        """Whether a smaller covariance would make a collision more likely."""
        return self.scale < 1.0


def chance(encounter: Encounter) -> Chance:
    """Return how likely a collision is in a short encounter."""
    miss, covariance = in_plane(encounter)
    along, sigmas = principal(miss, covariance, encounter.radius)

    def by_scale(scale: float) -> float:
        return integral(along, scale * sigmas, encounter.radius)

    most, scale = _largest(by_scale)
    return Chance(by_scale(1.0), most, scale, is_flat(covariance))


def principal(miss: np.ndarray, covariance: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a miss (2,) and standard deviations (2,) in the principal axes of a covariance (2, 2)."""
    variances, axes = np.linalg.eigh(covariance)
    return axes.T @ miss, np.sqrt(np.maximum(variances, (LEAST_SIGMA * radius) ** 2))


def is_flat(covariance: np.ndarray) -> bool:
    """Return whether a covariance (n, n) is none, or has a direction without variance, but for rounding."""
    variances = np.linalg.eigvalsh(covariance)
    return bool(variances[0] <= _ROUNDING * max(variances[-1], 0.0))


def in_plane(encounter: Encounter) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative position (2,) [m] and its covariance (2, 2) [m2] across the relative velocity."""
    ahead = encounter.velocity / np.linalg.norm(encounter.velocity)
    across = encounter.position - (encounter.position @ ahead) * ahead
    if not np.linalg.norm(across) > 0.0:
        across = np.cross(ahead, np.eye(3)[np.argmin(np.abs(ahead))])
    first = across / np.linalg.norm(across)
    plane = np.stack([first, np.cross(ahead, first)])
    return plane @ encounter.position, plane @ encounter.covariance @ plane.T


def integral(middle: np.ndarray, sigmas: np.ndarray, radius: float) -> float:
    """Return the share of a normal distribution that lies in a circle about the origin.

    middle, sigmas: (2,) of the distribution in its principal axes [m]
    radius: of the circle [m]

    Panels of Gauss's quadrature follow the distribution along the axis in which it is narrower.
    """
    narrow = int(np.argmin(sigmas))
    (m, s), (m_wide, s_wide) = ((middle[k], sigmas[k]) for k in (narrow, 1 - narrow))
    # x = radius sin(angle) takes the roots of the circle's ends out of the integrand.
    edges = np.arcsin(np.clip((m + s * _EDGES) / radius, -1.0, 1.0))
    edges = np.unique(np.concatenate([edges, _EIGHTHS]))
    middles, halves = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    angle = (middles[:, None] + halves[:, None] * _NODES).ravel()
    weight = (halves[:, None] * _WEIGHTS).ravel()
    x, half_chord = radius * np.sin(angle), radius * np.cos(angle)
    density = np.exp(-0.5 * ((x - m) / s) ** 2) / (s * math.sqrt(2.0 * math.pi))
    low, high = (-half_chord - abs(m_wide)) / s_wide, (half_chord - abs(m_wide)) / s_wide
    return min(float(np.sum(weight * half_chord * density * (ndtr(high) - ndtr(low)))), 1.0)


def _largest(by_scale: Callable[[float], float]) -> tuple[float, float]:
    """Return the largest probability by a factor of the standard deviations, and that factor."""
    probabilities = [by_scale(scale) for scale in _SCALES]
    k = int(np.argmax(probabilities))
    if probabilities[k] == 0.0:
        return 0.0, 1.0
    bounds = np.log(_SCALES[max(k - 1, 0)]), np.log(_SCALES[min(k + 1, len(_SCALES) - 1)])
    optimum = minimize_scalar(
        lambda logarithm: -by_scale(math.exp(logarithm)), bounds=bounds, method="bounded"
    )
    return max((-float(optimum.fun), math.exp(optimum.x)), (probabilities[k], float(_SCALES[k])))
