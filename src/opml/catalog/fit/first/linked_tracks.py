"""A first orbit for tracks of angles, with range rates or without: from two tracks or more that it links.

Each track of the first day is fitted alone, from the circular orbits through its first and its last line of
sight (`round_orbits`), with an eccentricity of 0, give or take `ROUND`. Such a fit knows the direction well,
the semi-major axis to a hundred kilometres: half a day later it may be anywhere on its orbit. So the next
track is looked for along the line of orbits that fit the first one as well (Milani & Gronchi 2010, ch. 10),
and both are fitted together, from those that pass its line of sight nearest. Where orbits near a circle do
not link all tracks, the same is tried with any eccentricity.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from opml.base.errors import InputError
from opml.catalog.fit.estimate import Estimate
from opml.catalog.fit.estimation import Run
from opml.catalog.fit.first.round_orbits import round_orbits
from opml.catalog.fit.first.track_fits import (
    axis_line,
    axis_sigma,
    first_windows,
    following,
    start_estimate,
    start_estimate_there,
)
from opml.catalog.fit.measurements import Window
from opml.catalog.fit.neighbour_arcs import propagate_parameters

FEWEST = 3  # measurements of a track that an orbit is looked for from
SHORTEST = 30.0  # shortest track that an orbit is looked for from [s]
ROUND = 0.02  # standard deviation of the eccentricity of orbits near a circle
FIRSTS = 3  # tracks from which orbits go on at most

ENOUGH = 3
"""Tracks besides the first: an orbit is right that links so many and all, and wrong where it links none."""

NOISE = 3.0
"""Residuals of tracks that belong together at most, in standard deviations: their root mean square."""

FARTHEST = 5e3
"""The same in the median, where they are larger, as the model errs more than precise tracks do [m]."""

_ITERATIONS = 60  # iterations of these fits at most: some come from far
_SPACING = 200e3  # distance between neighbouring orbits of the line, at the next track [m]
_MOST = 401  # orbits of the line at most
_WIDTH = 3.0  # how far the line goes on, in formal uncertainties of the semi-major axis
_TRIALS = 3  # orbits of the line that are fitted at most

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class TrackSeries:
    """Fits to one track more each."""

    first: int  # track that they begin with
    last: Estimate  # to all that were linked
    linked: int  # number of tracks besides the first
    following: int  # number of those that were tried

    @property
    def is_whole(self) -> bool:
        """Whether all tracks are linked, and enough of them."""
        return self.linked == self.following >= ENOUGH

    @property
    def is_one_orbit(self) -> bool:
        """Whether any track is linked, and at least half of those that were tried."""
        return self.linked >= max(1.0, 0.5 * self.following)


def orbit_of_angles(run: Run) -> Estimate:
    """Return the fit that links the most tracks.

    Raises InputError where no track gives an orbit, and where no two tracks fit one.
    """
    run = replace(run, settings=run.settings.evolve(max_iterations=_ITERATIONS))
    tried: list[TrackSeries] = []
    for sigma in (ROUND, None):
        trying = replace(run, eccentricity_sigma=sigma)
        for first in single_tracks(trying)[:FIRSTS]:
            tried.append(_linked(trying, first))
            if tried[-1].is_whole:
                return tried[-1].last
    right = [one for one in tried if one.is_one_orbit]
    if not right:
        problem = f"{run.propagator.rso.name}: expected {_expected(run, tried)}"
        raise InputError(f"{problem}; give elements, or a TLE or OEM under starts")
    return max(right, key=lambda one: (one.linked, -_cost(run, one.last))).last


def _expected(run: Run, tried: Sequence[TrackSeries]) -> str:
    """Return what the tracks should have been, and what they were."""
    if not tried:
        return (
            f"a track on the first day of two angles, {SHORTEST:g} s long, with 5 ranges or {FEWEST} "
            "measurements without, got none that gives an orbit"
        )
    most, hours = max(tried, key=lambda one: one.linked), run.settings.window_hours
    return (
        f"tracks of angles that fit one orbit, got {most.following} in {hours:g} h after track "
        f"{most.first} of which {most.linked} do"
    )


def single_tracks(run: Run) -> list[Estimate]:
    """Return the fits that converge on closed orbits, each to one track of the first day.

    Those whose semi-major axis is known best come first.
    """
    gm, orbits = run.propagator.model.gm, []
    for window in first_windows(run.measured):
        t, (standing, sights) = run.measured.times(window.rows), run.measured.lines(window.rows)
        known = np.flatnonzero(np.isfinite(sights).all(axis=1))
        if len(np.unique(t[known])) < FEWEST or np.ptp(t[known]) < SHORTEST:
            continue
        ends = known[[0, -1]]
        states = round_orbits(t[ends], standing[ends], sights[ends], gm)
        orbits += _fitted(run, [start_estimate(run, window, t[ends[0]], state) for state in states])[:1]
    closed = [one for one in orbits if np.isfinite(axis_sigma(one.fit, gm))]
    return sorted(closed, key=lambda one: axis_sigma(one.fit, gm))


def _linked(run: Run, first: Estimate) -> TrackSeries:
    """Return the series from a fit to one track, each from the last that fits."""
    last, linked, count = first, 0, 0
    for window in following(run, first.window):
        starts = _starts(run, last, window)
        fits = _fitted(run, [start_estimate_there(run, window, start) for start in starts])
        near = [one for one in fits[:1] if _is_near(run, one)]
        last, linked, count = near[0] if near else last, linked + len(near), count + 1
        if not linked and count == ENOUGH:
            break
    track = first.window.track
    _log.info("first orbit: of angles from track %d, %d of %d tracks linked", track, linked, count)
    return TrackSeries(track, last, linked, count)


def _fitted(run: Run, estimates: Sequence[Estimate]) -> list[Estimate]:
    run.fit(estimates)
    return sorted((one for one in estimates if one.fit.converged), key=lambda one: one.fit.cost)


def _starts(run: Run, last: Estimate, window: Window) -> np.ndarray:
    """Return parameters (n, 7) at a window's epoch, of the orbits of the line that pass its track nearest."""
    line, sides = axis_line(last.fit, run.propagator.model.gm), np.array([[-1.0], [1.0]])
    one, other = _propagated(run, last.window, last.fit.best + sides * line, window)[:, :3]
    wide = np.nan_to_num(_WIDTH * np.linalg.norm(other - one) / _SPACING, nan=_MOST)
    parts = np.linspace(-_WIDTH, _WIDTH, 2 * int(min(wide, _MOST) / 2) + 1) if wide >= 2.0 else np.zeros(1)
    ends = _propagated(run, last.window, last.fit.best + parts[:, None] * line, window)
    row = np.full(len(ends), run.measured.first_row[window.track])
    distances = run.measured.distances(row, ends[:, :3])
    padded = np.pad(np.where(np.isfinite(distances), distances, np.inf), 1, constant_values=np.inf)
    nearest = np.flatnonzero((distances <= padded[:-2]) & (distances <= padded[2:]))
    return ends[nearest[np.argsort(distances[nearest])][:_TRIALS]]


def _propagated(run: Run, begin: Window, parameters: np.ndarray, end: Window) -> np.ndarray:
    """Return parameters (n, 7) at the epoch of a window propagated to that of another, NaN where lost."""
    epochs, count = run.measured.epochs[[begin.at, end.at]], len(parameters)
    arcs = propagate_parameters(run.propagator, epochs, parameters, np.zeros(count, int), np.ones(count, int))
    return np.column_stack([np.vstack([arcs.path(k) for k in range(count)]), parameters[:, 6]])


def _is_near(run: Run, estimate: Estimate) -> bool:
    """Whether the tracks of a fit belong together: within their noise, or what the model errs."""
    if _cost(run, estimate) < NOISE**2:
        return True
    rows = np.arange(len(run.measured.epoch_of_row))[estimate.window.rows]
    positions = run.path(estimate)[run.measured.epoch_of_row[rows] - estimate.window.first, :3]
    return bool(np.median(run.measured.distances(rows, positions)) < FARTHEST)


def _cost(run: Run, estimate: Estimate) -> float:
    """Return the mean of the squares of a fit's residuals, with what is known beforehand."""
    return estimate.fit.cost / run.measured.count(estimate.window.rows)
