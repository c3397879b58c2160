"""Reader of points of an orbit for fits, from files in SP3, CPF, OEM or CSV: times, GCRF states, sigmas.

They are taken as they are, without a curve through them: a fit weighs each by its standard deviations.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.base.section import JobSettings
from opml.interop import ccsds, fixes_csv, tdm
from opml.interop.curves.orbit_curve import rotate_to_gcrf
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.interop.orbit_arcs import MOST_APART, Arc, contents
from opml.interop.orbit_from_files import OrbitFiles, arcs_of_files, check_together, is_orbit, outside
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import FIX_SIGMAS, STATE

ALIEN = 0.03
"""Part of a step between two points by which velocities usually miss it that are in another frame or unit.

Those of an orbit miss one of MOST_APART by a hundredth; the Earth's turn is 0.07 of the speed of a low orbit.
"""

_log = logging.getLogger(__name__)

_Points = tuple[Arc, np.ndarray]  # an arc, and the standard deviations (n, 6) of its points in RSW


@dataclass(frozen=True)
class Sampling:
    """How points are taken from files.

    sigmas: (3,) or (6,) standard deviations in RSW [m, m/s] of points whose file has none; velocities count
        where theirs are known
    every: least time from a point to the next [s]: one point is kept of each such step since the epoch
    """

    sigmas: Sequence[float]
    every: float = 0.0


class FixTaking(JobSettings):
    """How a job takes the fixes of an object; satellite: which one, where files have several."""

    sigmas: tuple[float, ...]
    every_s: float
    stretch_hours: float
    satellite: str | None = None

    @property
    def sampling(self) -> Sampling:
        """How points are taken."""
        return Sampling(self.sigmas, self.every_s)


def is_measured(path: FilePath) -> bool:
    """Return whether a file has points (SP3, CPF, OEM, CSV) or tracks; a folder is one of element sets."""
    if Path(path).is_dir():
        return False
    content = contents(path)
    return tdm.matches(content) or is_orbit(content) or fixes_csv.matches(content)


def check(files: OrbitFiles, sampling: Sampling) -> None:
    """Raise InputError where no points could be made of these files, as `read` does, without the frames."""
    for arc, sigmas in _within(files, sampling):
        _check_velocities(arc, sigmas)


def read(files: OrbitFiles, orientation: pd.DataFrame, sampling: Sampling) -> pd.DataFrame:
    """Return points within the run, in the order of time: t, state in GCRF, standard deviations in RSW.

    orientation: table `earth_orientation` over the run

    Where files or segments overlap, that with the later beginning counts. Raises InputError, naming file and
    line, for files as `orbit_from_files.arcs_of_files` and `fixes_csv.read` refuse them, for nothing within
    the run, and for velocities that are not those of the positions.
    """
    parts = []
    for arc, sigmas in _within(files, sampling):
        _check_velocities(arc, sigmas)
        parts.append(pd.DataFrame(rotate_to_gcrf(arc, orientation), columns=STATE).assign(t=arc.t))
        parts[-1][FIX_SIGMAS] = sigmas
    return pd.concat(parts, ignore_index=True).sort_values("t", ignore_index=True)


def reach(files: OrbitFiles) -> tuple[float, float]:
    """Return when the first and the last point of files are [s], in the run or not; raises as `read` does."""
    arcs = [arc for arc, _ in _weighted(files, Sampling(()))]
    return float(arcs[0].t[0]), max(float(arc.t[-1]) for arc in arcs)


def identity_and_burns(files: OrbitFiles) -> tuple[ObjectId, list[Manoeuvre]]:
    """Return what files tell beside points: the object, and when it manoeuvred; a CSV says nothing."""
    arcs = arcs_of_files(files) if is_orbit(contents(files.paths[0])) else []
    marked = sorted({t for arc in arcs for t in arc.burns})
    identity = replace(arcs[0].identity, name=arcs[0].identity.name or arcs[0].satellite) if arcs else UNKNOWN
    return identity, [Manoeuvre(t, known=t) for t in marked]


def _within(files: OrbitFiles, sampling: Sampling) -> list[_Points]:
    """Return the points within the run by arc, without overlap, and thinned.

    Where velocities count, a point without one is left out.
    """
    arcs = _weighted(files, sampling)
    counting = [np.isfinite(np.hstack([arc.velocities, sigmas[:, 3:]])).all(axis=1) for arc, sigmas in arcs]
    with_velocities = any(rows.any() for rows in counting)
    kept = []
    for k, (arc, sigmas) in enumerate(arcs):
        rows = np.isfinite(arc.positions).all(axis=1) & (arc.t >= 0.0) & (arc.t <= files.duration)
        for later, _ in arcs[k + 1 :]:
            rows &= (arc.t < later.t[0]) | (arc.t > later.t[-1])
        if with_velocities:
            rows &= counting[k]
        else:
            sigmas[:, 3:] = np.nan
        rows &= _thinned(arc.t, rows, sampling.every)
        if rows.any():
            kept.append((arc.part(rows), sigmas[rows]))
    if not kept:
        raise outside([arc for arc, _ in arcs], files)
    _tell_outside([arc for arc, _ in arcs], files)
    return kept


def _tell_outside(arcs: Sequence[Arc], files: OrbitFiles) -> None:
    """Log the first of the files whose points are all outside of the run, as by a clock that restarted."""
    reached = {arc.path for arc in arcs if arc.t[-1] >= 0.0 and arc.t[0] <= files.duration}
    if left_out := [arc for arc in arcs if arc.path not in reached]:
        one, count = left_out[0], len({arc.path for arc in left_out})
        begin, end = ccsds.utc_texts(files.epoch, one.t[[0, -1]])
        run = ccsds.utc_texts(files.epoch, np.array([0.0, files.duration]))
        told = "files without a point from %s to %s: %d, as %s, of %s to %s"
        _log.warning(told, *run, count, one.path, begin, end)


def _weighted(files: OrbitFiles, sampling: Sampling) -> list[_Points]:
    """Return the arcs of files in the order of their beginnings, with the sigmas (n, 6) of their points."""
    usual = np.full(len(FIX_SIGMAS), np.nan)
    usual[: len(sampling.sigmas)] = sampling.sigmas
    if is_orbit(contents(files.paths[0])):
        return [(arc, np.tile(usual, (len(arc.t), 1))) for arc in arcs_of_files(files)]
    arcs = [_of_csv(path, files) for path in dict.fromkeys(files.paths)]
    check_together([arc for arc, _ in arcs])
    arcs.sort(key=lambda pair: float(pair[0].t[0]))
    return [(arc, np.where(np.isfinite(sigmas), sigmas, usual)) for arc, sigmas in arcs]


def _of_csv(path: FilePath, files: OrbitFiles) -> _Points:
    content = contents(path)
    if is_orbit(content):
        raise InputError(f"{path}: expected the format of {files.paths[0]}, got another")
    return fixes_csv.read(path, content, epoch=files.epoch, satellite=files.satellite)


def _thinned(t: np.ndarray, rows: np.ndarray, every: float) -> np.ndarray:
    """Return which points (n,) are the first of `rows` (n,) in their step of `every` [s] since the epoch."""
    if not every > 0.0:
        return rows
    first = np.zeros(len(t), bool)
    kept = np.flatnonzero(rows)
    first[kept[np.unique(np.floor(t[kept] / every), return_index=True)[1]]] = True
    return first


def _check_velocities(arc: Arc, sigmas: np.ndarray) -> None:
    """Raise InputError where velocities that count do not lead from each position to the next."""
    steps = np.diff(arc.t)
    near = np.isfinite(sigmas[1:, 3]) & np.isfinite(sigmas[:-1, 3]) & (steps <= MOST_APART)
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
