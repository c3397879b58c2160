"""Reader of points of an orbit for fits, from files of its formats: times, GCRF states, sigmas.

They are taken as they are, without a curve through them: a fit weighs each by its standard deviations.
"""

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
import pandas as pd
from pydantic import Strict

from opml.base.errors import InputError
from opml.base.section import Section, absent, setting
from opml.base.setting_types import Absent, Expected, NotNegative, Positive
from opml.interop import ccsds
from opml.interop.object_ids import ObjectId
from opml.interop.orbit_arcs import MOST_APART, Arc
from opml.interop.orbit_from_files import OrbitFiles, arcs_of_files, outside
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, STATE

ALIEN = 0.03
"""Part of a step between two points by which velocities usually miss it that are in another frame or unit.

Those of an orbit miss one of MOST_APART by a hundredth; the Earth's turn is 0.07 of the speed of a low orbit.
"""

_log = logging.getLogger(__name__)


Sigmas = Annotated[tuple[Positive, Positive, Positive], Strict(False), Expected("three numbers above 0")]


class FixSettings(Section):
    """Reading of an RSO's fixes."""

    sigma_m: Sigmas = setting(
        "standard deviations of positions if the file has none: radial, along-track, cross-track",
        unit="m",
        default=(10.0, 10.0, 10.0),
    )
    sigma_mps: Absent[Sigmas] = absent(
        "the same of velocities; without them, and without columns of theirs, positions alone are fitted",
        unit="m/s",
    )
    every_s: NotNegative = setting(
        "step of time of which one fix is taken, the first; 0 takes all", unit="s", default=60.0
    )
    stretch_hours: Positive = setting(
        "fixes of so long make a track, whose estimate is at the first of them", unit="h", default=1.0
    )

    @property
    def sigmas(self) -> tuple[float, ...]:
        """Standard deviations in RSW of positions [m], and of velocities [m/s] where they count."""
        return (*self.sigma_m, *(self.sigma_mps or ()))


def check(files: OrbitFiles, settings: FixSettings) -> None:
    """Raise InputError where no points could be made of these files, as `read` does, without the frames."""
    for arc in _within(files, settings):
        _check_velocities(arc)


def read(files: OrbitFiles, orientation: pd.DataFrame, settings: FixSettings) -> pd.DataFrame:
    """Return points within the run, in the order of time: t, state in GCRF, standard deviations in RSW.

    orientation: table `earth_orientation` over the run

    Where files or segments overlap, that with the later beginning counts. Raises InputError, naming file and
    line, for files as `orbit_from_files.arcs_of_files` refuses them, for nothing within the run, and for
    velocities that are not those of the positions.
    """
    from opml.interop.curves.orbit_curve import (
        rotate_to_gcrf,
    )  # its kernels take a second, which plans have not

    parts = []
    for arc in _within(files, settings):
        _check_velocities(arc)
        parts.append(pd.DataFrame(rotate_to_gcrf(arc, orientation), columns=STATE).assign(t=arc.t))
        parts[-1][FIX_SIGMAS] = arc.sigmas
    return pd.concat(parts, ignore_index=True).sort_values("t", ignore_index=True)


def reach(files: OrbitFiles) -> tuple[float, float]:
    """Return when the first and the last point of files are [s], in the run or not; raises as `read` does."""
    arcs = arcs_of_files(files)
    return float(arcs[0].t[0]), max(float(arc.t[-1]) for arc in arcs)


def identity_and_burns(files: OrbitFiles) -> tuple[ObjectId, list[Manoeuvre]]:
    """Return the object of files, and its manoeuvres."""
    arcs = arcs_of_files(files)
    return arcs[0].owner, [Manoeuvre(t, known=t) for t in sorted({t for arc in arcs for t in arc.burns})]


def _within(files: OrbitFiles, settings: FixSettings) -> list[Arc]:
    """Return the points within the run by arc, with their sigmas, without overlap, and thinned.

    Where velocities count, a point without one is left out.
    """
    arcs = arcs_of_files(files)
    sigmas = [_sigmas(arc, settings) for arc in arcs]
    counting = [
        np.isfinite(np.hstack([arc.velocities, own[:, 3:]])).all(axis=1)
        for arc, own in zip(arcs, sigmas, strict=True)
    ]
    with_velocities = any(rows.any() for rows in counting)
    kept = []
    for k, arc in enumerate(arcs):
        rows = np.isfinite(arc.positions).all(axis=1) & (arc.t >= 0.0) & (arc.t <= files.duration)
        for later in arcs[k + 1 :]:
            rows &= (arc.t < later.t[0]) | (arc.t > later.t[-1])
        if with_velocities:
            rows &= counting[k]
        else:
            sigmas[k][:, 3:] = np.nan
        rows &= _thinned(arc.t, rows, settings.every_s)
        if rows.any():
            kept.append(replace(arc, sigmas=sigmas[k]).part(rows))
    if not kept:
        raise outside(arcs, files)
    _tell_outside(arcs, files)
    return kept


def _tell_outside(arcs: Sequence[Arc], files: OrbitFiles) -> None:
    """Log the first of the files whose points are all outside of the run, as by a clock that restarted."""
    reached = {arc.path for arc in arcs if arc.t[-1] >= 0.0 and arc.t[0] <= files.duration}
    if left_out := [arc for arc in arcs if arc.path not in reached]:
        one, count = left_out[0], len({arc.path for arc in left_out})
        begin, end = ccsds.utc_texts(files.epoch, one.t[[0, -1]])
        run = ccsds.utc_texts(files.epoch, np.array([0.0, files.duration]))
        text = "files without a point from %s to %s: %d, as %s, of %s to %s"
        _log.warning(text, *run, count, one.path, begin, end)


def _sigmas(arc: Arc, settings: FixSettings) -> np.ndarray:
    """Return the standard deviations (n, 6) of an arc's points: its own, else those of the settings."""
    usual = np.full(len(FIX_SIGMAS), np.nan)
    usual[: len(settings.sigmas)] = settings.sigmas
    own = np.nan if arc.sigmas is None else arc.sigmas
    return np.where(np.isfinite(own), own, np.tile(usual, (len(arc.t), 1)))


def _thinned(t: np.ndarray, rows: np.ndarray, every: float) -> np.ndarray:
    """Return which points (n,) are the first of `rows` (n,) in their step of `every` [s] since the epoch."""
    if not every > 0.0:
        return rows
    first = np.zeros(len(t), bool)
    kept = np.flatnonzero(rows)
    first[kept[np.unique(np.floor(t[kept] / every), return_index=True)[1]]] = True
    return first


def _check_velocities(arc: Arc) -> None:
    """Raise InputError where velocities that count do not lead from each position to the next."""
    steps = np.diff(arc.t)
    counting = np.full(len(arc.t), False) if arc.sigmas is None else np.isfinite(arc.sigmas[:, 3])
    near = counting[1:] & counting[:-1] & (steps <= MOST_APART)
    if not near.any():
        return
    moved = np.diff(arc.positions, axis=0)[near]
    expected = 0.5 * (arc.velocities[1:] + arc.velocities[:-1])[near] * steps[near, None]
    miss = float(np.median(np.linalg.norm(expected - moved, axis=1) / np.linalg.norm(moved, axis=1)))
    if miss > ALIEN:
        raise InputError(
            f"{arc.path}: expected velocities that lead from each position to the next, "
            f"got {100 * miss:.0f} % off: another unit or frame?"
        )
