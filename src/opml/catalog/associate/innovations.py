"""Innovations: a track's distance from its prediction by an earlier estimate, in standard deviations.

An estimate has parameters x and a covariance P = L L'. With the weighted residuals r of a later track, and
their partial derivatives A by x, the singular vectors of A L are the directions in which the prediction may
err, independently of each other:

    A L = U S V',  z = U'r,  z_i / sqrt(1 + s_i^2) ~ N(0, 1)

What no orbit could explain, such as an outlier of one measured number, is in none of the directions.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from opml.catalog.fit.apriori import CD, covariance_root, with_apriori_cd
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.neighbour_arcs import propagate_around

CD_SPREAD = 0.1
"""Variation of the Cd that a model needs, besides the noise of the fits, as a share of it.

Models of the thermosphere err by 10 to 15 % (Emmert 2015, Thermospheric mass density: A review, sec. 5).
"""

_USUAL = 1.67  # median of the largest of seven normal deviates
LEAST = 5  # fewest tracks that show how far is usual


@dataclass(frozen=True)
class ReferenceOrbit:
    """An earlier estimate, from which tracks are predicted."""

    track: int  # of its estimate
    at: int  # number of its epoch among the run's
    parameters: np.ndarray  # (7,)
    covariance: np.ndarray  # (7, 7)

    @classmethod
    def of_estimate(cls, estimate: Estimate, cd: float) -> Self | None:
        """Return the orbit of an estimate that takes the body's Cd for a measurement, if it can."""
        if not estimate.fit.converged:
            return None
        known = with_apriori_cd(estimate.fit.best, estimate.fit.covariance, cd)
        return cls(estimate.window.track, estimate.window.at, *known) if known else None

    def later_covariance(self, cd: float) -> np.ndarray:
        """Return the covariance (7, 7) that others are predicted with, as Cd may change by part of `cd`."""
        covariance = self.covariance.copy()
        covariance[CD, CD] += (CD_SPREAD * cd) ** 2
        return covariance


def deviations(evaluation: Evaluation, root: np.ndarray) -> np.ndarray:
    """Return the innovations (directions,) of a track [1], each in its own standard deviation."""
    axes, size, _ = np.linalg.svd(evaluation.jacobian @ root, full_matrices=False)
    along: np.ndarray = axes.T @ evaluation.residuals
    return along / np.sqrt(1.0 + size**2)


def farthest(run: Run, orbit: ReferenceOrbit, track: int) -> float:
    """Return the largest innovation of a track [1], predicted from an orbit before; infinite if lost."""
    alone = run.measured.track(track)
    window = replace(alone, first=min(orbit.at, alone.first), at=orbit.at)
    [around], [status] = propagate_around(
        run.propagator, run.measured.epochs, [window], orbit.parameters[None]
    )
    if status:
        return np.inf
    evaluation = run.measured.evaluation(window, around.states, light_time=run.settings.light_time)
    root = covariance_root(orbit.later_covariance(run.propagator.rso.cd))
    return float(np.abs(deviations(evaluation, root)).max())


def usual_scale(past: Sequence[float]) -> float:
    """Return a factor on standard deviations, at least 1, from the largest innovations of past tracks."""
    return max(1.0, float(np.median(past)) / _USUAL) if len(past) >= LEAST else np.inf
