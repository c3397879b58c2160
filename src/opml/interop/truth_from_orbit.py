"""A real orbit in the place of the simulated truth: from files in SP3, CPF or OEM to the `truth` table.

The nodes of all files are turned to GCRF with the package's own Earth orientation, bridged by the Earth's
gravity from node to node (opml.interop.bridging) and looked up on the run's grid. Nothing is bridged over
more than MOST_APART, nor over a break of the orbit (opml.interop.orbit_breaks); rows there are absent. Where
two files or segments overlap, the one that begins later counts.
"""

import logging
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.dynamics.attraction import Attraction
from opml.environment import earth_orientation, gravity_field, nodes
from opml.interop import ccsds, orbit_breaks
from opml.interop.orbit_arcs import Arc
from opml.interop.orbit_curve import ON_NODE, Curve, through
from opml.interop.orbit_from_files import gathered
from opml.tables import STATE

LIMIT = 3.0
"""Largest error of the interpolation that is accepted [m], a tenth of the noise of the paper's ranges.

It is the root mean square of what nodes, every second one left out, are missed by.
"""

LARGEST_STEP = 20e3
"""Largest step between two solutions of one orbit [m]: three seconds along the track of a low one."""

FIELD = "EGM2008"
"""Gravity field that bridges the nodes, to degree and order 70."""

_log = logging.getLogger(__name__)


def truth(
    paths: Sequence[FilePath],
    *,
    epoch: str,
    step: float,
    duration: float,
    satellite: str | None = None,
    limit: float = LIMIT,
) -> tuple[pd.DataFrame, dict[str, Any]]:
    """The `truth` table of an orbit in files: GCRF states every `step` from the epoch to `duration` [s].

    paths: files of one format, in any order; satellite: its name or id there, None is the only one there is;
    limit: of the interpolation's error [m]. Rows are absent where the orbit is not known. Returns the table,
    and what is to be told of it as JSON values: times in s since the epoch, and gaps, seams and manoeuvres.
    Raises InputError, naming file and line, for what `gathering.check` tells, and for too rough an orbit.
    """
    arcs = gathered(paths, epoch=epoch, duration=duration, satellite=satellite)
    curves = _curves(arcs, epoch, duration)
    grid = np.arange(0.0, duration + 0.5 * step, step)
    states, owner = _on_grid(curves, grid)
    known = np.isfinite(states).all(axis=1)
    if not known.any():
        raise InputError(f"{arcs[0].path}: expected an orbit on the run's grid, got none that is smooth")
    told = {
        **_origin(arcs),
        "interpolation_error_m": _error(curves),
        **_left_out(curves),
        "gaps": _gaps(grid, known, duration),
        **_told_breaks(curves, grid, owner),
    }
    _tell(told)
    _check_steps(arcs, told["seams"], epoch)
    _check_error(arcs, told["interpolation_error_m"], limit)
    columns = dict(zip(STATE, states[known].T, strict=True))
    return pd.DataFrame({"t": grid[known], **columns}), told


def _curves(arcs: Sequence[Arc], epoch: str, duration: float) -> list[Curve]:
    """Curves through the arcs, each of arcs that follow each other without overlap."""
    field = gravity_field.read_icgem(gravity_field.resolve(FIELD)).freeze(epoch)
    orientation = earth_orientation.tabulate(epoch, nodes(epoch, duration))
    attraction = Attraction(field.c, field.s, gm=field.gm, radius=field.radius, earth_orientation=orientation)
    ends = np.maximum.accumulate([arc.t[-1] for arc in arcs])
    begins = [k == 0 or arc.t[0] <= ends[k - 1] for k, arc in enumerate(arcs)]
    runs = groupby(zip(np.cumsum(begins), arcs, strict=True), key=lambda pair: pair[0])
    return [through([arc for _, arc in run], orientation, attraction) for _, run in runs]


def _on_grid(curves: Sequence[Curve], grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """States (m, 6) on the grid, not finite where unknown, and the curve that each is of, -1 for none."""
    states, owner = np.full((len(grid), 6), np.nan), np.full(len(grid), -1)
    for k, one in enumerate(curves):
        inside = (grid >= one.t[0] - ON_NODE) & (grid <= one.t[-1] + ON_NODE)
        states[inside], owner[inside] = one.at(grid[inside]), k
    return states, owner


def _origin(arcs: Sequence[Arc]) -> dict[str, Any]:
    """Where the orbit is from."""
    return {
        "files": list(dict.fromkeys(Path(arc.path).name for arc in arcs)),
        "satellite": arcs[0].satellite,
        "frame": ", ".join(dict.fromkeys(arc.realisation for arc in arcs)),
        "time_system": arcs[0].scale,
    }


def _error(curves: Sequence[Curve]) -> dict[str, float | None]:
    """Root mean square and maximum of what left out nodes are missed by [m]; None where there were none."""
    missed = np.concatenate([curve.missed for curve in curves])
    if not missed.size:
        return {"rms": None, "max": None}
    return {"rms": float(np.sqrt(np.mean(missed**2))), "max": float(missed.max())}


def _left_out(curves: Sequence[Curve]) -> dict[str, int]:
    """How many positions and velocities of the files do not fit the others."""
    positions, velocities = np.sum([curve.left_out for curve in curves], axis=0)
    return {"positions_left_out": int(positions), "velocities_left_out": int(velocities)}


def _gaps(grid: np.ndarray, known: np.ndarray, duration: float) -> list[list[float]]:
    """Times between which the orbit is not known, from the last row before to the first one after [s]."""
    fenced = np.concatenate([[True], known, [True]])
    times = np.concatenate([[0.0], grid, [duration]])
    rows = np.flatnonzero(fenced)
    wide = np.flatnonzero(np.diff(rows) > 1)
    return [[float(times[rows[k]]), float(times[rows[k + 1]])] for k in wide]


def _told_breaks(curves: Sequence[Curve], grid: np.ndarray, owner: np.ndarray) -> dict[str, Any]:
    """Seams and manoeuvres within the run, each by time [s]."""
    seams, manoeuvres = _changeovers(curves, grid, owner), []
    for k, curve in enumerate(curves):
        for one in curve.found:
            if owner[np.argmin(np.abs(grid - one.t))] != k or not grid[0] <= one.t <= grid[-1]:
                continue
            if one.one_way:
                manoeuvres.append({"t": one.t, "dv_mps": one.velocity})
            elif one.is_seam:
                seams.append({"t": one.t, "step_m": one.step})
    return {
        "seams": sorted(seams, key=lambda seam: seam["t"]),
        "manoeuvres": sorted(manoeuvres, key=lambda manoeuvre: manoeuvre["t"]),
    }


def _changeovers(curves: Sequence[Curve], grid: np.ndarray, owner: np.ndarray) -> list[dict[str, float]]:
    """Seams where one curve takes over from another that reaches there as well."""
    seams = []
    for row in np.flatnonzero(np.diff(owner)) + 1:
        if min(owner[row - 1], owner[row]) < 0:
            continue
        before, after = (curves[owner[k]].at(grid[row : row + 1])[0, :3] for k in (row - 1, row))
        step = float(np.linalg.norm(after - before))
        if step >= orbit_breaks.LEAST_SEAM:
            seams.append({"t": float(grid[row]), "step_m": step})
    return seams


def _tell(told: dict[str, Any]) -> None:
    """Log what is told of an orbit."""
    error = told["interpolation_error_m"]
    _log.info("orbit of %s in %s, %s", told["satellite"], told["frame"], told["time_system"])
    if error["rms"] is not None:
        _log.info("each second node is predicted to %.2g m rms, %.2g m at most", error["rms"], error["max"])
    if told["velocities_left_out"]:
        _log.info("%d velocities are left out, as positions tell more", told["velocities_left_out"])
    for start, end in told["gaps"]:
        _log.info("no orbit is known between %.0f s and %.0f s", start, end)
    for seam in told["seams"]:
        _log.info("seam at %.0f s: a step of %.2f m", seam["t"], seam["step_m"])
    for manoeuvre in told["manoeuvres"]:
        _log.info("manoeuvre at %.0f s: %.4f m/s", manoeuvre["t"], manoeuvre["dv_mps"])


def _check_steps(arcs: Sequence[Arc], seams: Sequence[dict[str, float]], epoch: str) -> None:
    """Raise InputError where the orbit goes on so far away that it cannot be the same."""
    for seam in seams:
        if seam["step_m"] > LARGEST_STEP:
            path = [arc.path for arc in arcs if arc.t[0] <= seam["t"]][-1]
            at = ccsds.utc_texts(epoch, np.array([seam["t"]]))[0]
            raise InputError(
                f"{path}: expected one orbit, got a step of {seam['step_m'] / 1e3:.0f} km at {at}"
            )


def _check_error(arcs: Sequence[Arc], error: dict[str, float | None], limit: float) -> None:
    if error["rms"] is not None and error["rms"] > limit:
        expected = f"nodes that predict each other to {limit:g} m"
        raise InputError(
            f"{arcs[0].path}: expected {expected}, got {error['rms']:.3g} m: noisy, or too far apart"
        )
