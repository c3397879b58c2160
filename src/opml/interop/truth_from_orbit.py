"""The table `truth` from a real orbit in SP3, CPF or OEM, in place of a simulated one.

The nodes of all files are rotated to GCRF with the package's Earth orientation, bridged by the Earth's
gravity from node to node (curves.gravity_interpolation) and interpolated on the run's grid. Intervals longer
than MOST_APART and breaks of the orbit (curves.orbit_breaks) stay open; the table has no rows there. Where
files or segments overlap, that with the later beginning counts.
"""

import logging
from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from opml.base.errors import InputError
from opml.dynamics.attraction import Attraction
from opml.environment import earth_orientation, gravity_field, nodes
from opml.interop import ccsds, object_ids
from opml.interop.curves import orbit_breaks
from opml.interop.curves.orbit_curve import ON_NODE, OrbitCurve, fit_curve
from opml.interop.orbit_arcs import MOST_APART, Arc
from opml.interop.orbit_from_files import OrbitFiles, read_arcs
from opml.tables import STATE

LIMIT = 3.0
"""Largest accepted error of the interpolation [m], a tenth of the noise of the paper's ranges.

The error is the root mean square distance of the other nodes from the curve through every second one.
"""

LARGEST_STEP = 20e3
"""Largest step between two solutions of one orbit [m]: three seconds along the track of a low one."""

FIELD = "EGM2008"  # gravity field that bridges the nodes, to degree and order 70

_log = logging.getLogger(__name__)


def truth(files: OrbitFiles, *, step: float, limit: float = LIMIT) -> tuple[pd.DataFrame, dict[str, Any]]:
    """Return the table `truth` of an orbit in files, and facts about the orbit for the table's metadata.

    step: between rows [s], from the epoch to the end of the run
    limit: of the interpolation's error [m]

    Rows are absent where the orbit is unknown. The facts are JSON values: origin, error, gaps, seams and
    manoeuvres, with times in s since the epoch. Raises InputError, naming file and line, as `read_arcs` does,
    and for an orbit that is too rough.
    """
    arcs = read_arcs(files)
    curves = _curves(arcs, files.epoch, files.duration)
    grid = np.arange(0.0, files.duration + 0.5 * step, step)
    states, owner = _sample(curves, grid)
    known = np.isfinite(states).all(axis=1)
    if not known.any():
        raise InputError(f"{arcs[0].path}: expected an orbit on the run's grid, got none that is smooth")
    positions, velocities = np.sum([curve.left_out for curve in curves], axis=0).tolist()
    facts = {
        "files": list(dict.fromkeys(Path(arc.path).name for arc in arcs)),
        "satellite": arcs[0].satellite,
        "frame": ", ".join(dict.fromkeys(arc.realisation for arc in arcs)),
        "time_system": arcs[0].scale,
        **object_ids.facts(arcs[0].identity),
        "interpolation_error_m": _interpolation_error(curves),
        "positions_left_out": positions,
        "velocities_left_out": velocities,
        "gaps": _gaps(grid, known, files.duration),
        **_breaks(curves, grid, owner, {t for arc in arcs for t in arc.burns}),
    }
    _log_facts(facts)
    _check_steps(arcs, facts["seams"], files.epoch)
    if (rms := facts["interpolation_error_m"]["rms"]) is not None and rms > limit:
        expected = f"nodes that predict each other to {limit:g} m"
        raise InputError(f"{arcs[0].path}: expected {expected}, got {rms:.3g} m: noisy, or too sparse")
    columns = dict(zip(STATE, states[known].T, strict=True))
    return pd.DataFrame({"t": grid[known], **columns}), facts


def _curves(arcs: Sequence[Arc], epoch: str, duration: float) -> list[OrbitCurve]:
    """Return curves through the arcs, one for each sequence of arcs without overlap."""
    field = gravity_field.read_icgem(gravity_field.resolve(FIELD)).freeze(epoch)
    orientation = earth_orientation.tabulate(epoch, nodes(epoch, duration))
    attraction = Attraction(field.c, field.s, gm=field.gm, radius=field.radius, earth_orientation=orientation)
    ends = np.maximum.accumulate([arc.t[-1] for arc in arcs])
    begins = [k == 0 or arc.t[0] <= ends[k - 1] for k, arc in enumerate(arcs)]
    runs = groupby(zip(np.cumsum(begins), arcs, strict=True), key=lambda pair: pair[0])
    return [fit_curve([arc for _, arc in run], orientation, attraction) for _, run in runs]


def _sample(curves: Sequence[OrbitCurve], grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the states (m, 6) on the grid, not finite where unknown, and the index of each state's curve.

    The last curve that covers a time counts; -1 stands for no curve.
    """
    states, owner = np.full((len(grid), 6), np.nan), np.full(len(grid), -1)
    for k, curve in enumerate(curves):
        inside = (grid >= curve.t[0] - ON_NODE) & (grid <= curve.t[-1] + ON_NODE)
        states[inside], owner[inside] = curve.interpolate(grid[inside]), k
    return states, owner


def _interpolation_error(curves: Sequence[OrbitCurve]) -> dict[str, float | None]:
    distances = np.concatenate([curve.distances for curve in curves])
    if not distances.size:
        return {"rms": None, "max": None}
    return {"rms": float(np.sqrt(np.mean(distances**2))), "max": float(distances.max())}


def _gaps(grid: np.ndarray, known: np.ndarray, duration: float) -> list[list[float]]:
    fenced = np.concatenate([[True], known, [True]])
    times = np.concatenate([[0.0], grid, [duration]])
    rows = np.flatnonzero(fenced)
    wide = np.flatnonzero(np.diff(rows) > 1)
    return [[float(times[rows[k]]), float(times[rows[k + 1]])] for k in wide]


def _breaks(
    curves: Sequence[OrbitCurve], grid: np.ndarray, owner: np.ndarray, marked: Iterable[float]
) -> dict[str, Any]:
    """Return seams and manoeuvres within the run, in order of time [s].

    marked: when files have the satellite manoeuvre [s], whether it shows in the orbit or not
    """
    seams, manoeuvres = _changeovers(curves, grid, owner), []
    for k, curve in enumerate(curves):
        for event in curve.breaks:
            if owner[np.argmin(np.abs(grid - event.t))] != k or not grid[0] <= event.t <= grid[-1]:
                continue
            if event.one_way:
                manoeuvres.append({"t": event.t, "dv_mps": event.velocity})
            elif event.is_seam:
                seams.append({"t": event.t, "step_m": event.step})
    shown = np.array([one["t"] for one in manoeuvres])
    manoeuvres += [
        {"t": t} for t in marked if grid[0] <= t <= grid[-1] and not (np.abs(shown - t) <= MOST_APART).any()
    ]
    return {
        "seams": sorted(seams, key=lambda seam: seam["t"]),
        "manoeuvres": sorted(manoeuvres, key=lambda manoeuvre: manoeuvre["t"]),
    }


def _changeovers(curves: Sequence[OrbitCurve], grid: np.ndarray, owner: np.ndarray) -> list[dict[str, float]]:
    """Return the seams where the grid changes from one curve to another that overlaps it."""
    seams = []
    for row in np.flatnonzero(np.diff(owner)) + 1:
        if min(owner[row - 1], owner[row]) < 0:
            continue
        before, after = (curves[owner[k]].interpolate(grid[row : row + 1])[0, :3] for k in (row - 1, row))
        step = float(np.linalg.norm(after - before))
        if step >= orbit_breaks.LEAST_SEAM:
            seams.append({"t": float(grid[row]), "step_m": step})
    return seams


def _log_facts(facts: dict[str, Any]) -> None:
    error = facts["interpolation_error_m"]
    _log.info("orbit of %s in %s, %s", facts["satellite"], facts["frame"], facts["time_system"])
    if error["rms"] is not None:
        _log.info("each second node is predicted to %.2g m rms, %.2g m at most", error["rms"], error["max"])
    if facts["velocities_left_out"]:
        _log.info("%d velocities are left out, as positions say more", facts["velocities_left_out"])
    for start, end in facts["gaps"]:
        _log.info("no orbit is known between %.0f s and %.0f s", start, end)
    for seam in facts["seams"]:
        _log.info("seam at %.0f s: a step of %.2f m", seam["t"], seam["step_m"])
    for manoeuvre in facts["manoeuvres"]:
        size = f"{manoeuvre['dv_mps']:.4f} m/s" if "dv_mps" in manoeuvre else "marked"
        _log.info("manoeuvre at %.0f s: %s", manoeuvre["t"], size)


def _check_steps(arcs: Sequence[Arc], seams: Sequence[dict[str, float]], epoch: str) -> None:
    for seam in seams:
        if seam["step_m"] > LARGEST_STEP:
            path = [arc.path for arc in arcs if arc.t[0] <= seam["t"]][-1]
            time = ccsds.utc_texts(epoch, np.array([seam["t"]]))[0]
            raise InputError(
                f"{path}: expected one orbit, got a step of {seam['step_m'] / 1e3:.0f} km at {time}"
            )
