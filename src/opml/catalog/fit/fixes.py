"""Positions, with velocities or without, as measurements of an orbit: GPS fixes, orbits.

Each is a point: a time, a GCRF state and its standard deviations along the radial direction, along the track
and across it (RSW). Points are grouped into arcs of an hour, say, as measurements of radars are into tracks.
The estimate of an arc is at its first point.

Residuals are measured less predicted, turned to RSW of the orbit tried. Their axes count as fixed while a fit
takes a step: a residual of 10 km turns with them by a thousandth of the step. Neighbouring arcs part by a
kilometre along the track in days, where the orbit bends by decimetres. That bend is none of the derivative.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import HOUR
from opml.base.errors import InputError
from opml.catalog import kinds
from opml.catalog.fit.laser_ranges import LaserRanges
from opml.catalog.fit.least_squares import Evaluation
from opml.catalog.fit.measurements import Measurements, Rows, Window
from opml.catalog.fit.neighbour_arcs import NUDGES
from opml.catalog.fit.observations import Measured
from opml.orbits.elements import rsw_rotation
from opml.orbits.manoeuvres import Manoeuvre, read_manoeuvres
from opml.orbits.sheets import Station
from opml.tables import FIX_SIGMAS, SCHEMAS, STATE, read_measured, read_table

ARC = HOUR  # length of an arc of points [s]


class Fixes(Measurements):
    """The points of a table `fixes`."""

    smooth_for = 1200.0

    def __init__(self, fixes: pd.DataFrame) -> None:
        """Take the table. Raises InputError where velocities count in some rows and not in others."""
        super().__init__(fixes["track"].to_numpy(), fixes["t"].to_numpy())
        counting = np.isfinite(fixes[FIX_SIGMAS[3:]].to_numpy()).all(axis=1)
        if counting.any() and not counting.all():
            t = fixes["t"].to_numpy()[~counting][0]
            raise InputError(
                f"fixes: expected sigmas of velocities in all rows or none, got none at {t:.3f} s"
            )
        self.numbers = len(STATE) if counting.all() else 3
        self.values = fixes[STATE[: self.numbers]].to_numpy()
        self.sigmas = fixes[FIX_SIGMAS[: self.numbers]].to_numpy()
        if not (np.isfinite(self.values).all() and np.all(self.sigmas > 0.0)):
            raise InputError("fixes: expected numbers, and sigmas above 0, of all that counts, got others")
        there = fixes[STATE].to_numpy()[self.first_row[:-1]]
        if np.isfinite(there).all():
            self.states = there

    def places(self, rows: Rows) -> np.ndarray:
        """Return positions (n, 3) in GCRF [m] of rows of points."""
        return self.values[rows][:, :3]

    def evaluation(self, window: Window, states: np.ndarray, *, light_time: bool = False) -> Evaluation:
        """Return residuals and partial derivatives, as `Measurements.evaluation`; no light has to travel."""
        rows = window.rows
        at_rows = states[:, self.epoch_of_row[rows] - window.first]
        axes = rsw_rotation(at_rows[0])
        paths, sigmas = at_rows[..., : self.numbers], self.sigmas[rows]
        residual = _in_axes(axes, self.values[rows] - paths[0]) / sigmas
        shifts = _in_axes(axes, paths[1:] - paths[0])
        # Circles fall below their tangents.
        radius = np.linalg.norm(paths[0][:, :3], axis=1)
        shifts[..., 0] += np.sum(shifts[..., 1:3] ** 2, axis=-1) / (2.0 * radius)
        weighted = shifts / sigmas / NUDGES[:, None, None]
        return Evaluation(residual.ravel(), weighted.reshape(len(NUDGES), -1).T)


def _in_axes(axes: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    parts = vectors.reshape(*vectors.shape[:-1], -1, 3)
    return np.einsum("nij,...nkj->...nki", axes, parts).reshape(vectors.shape)


MEASUREMENTS: dict[str, Callable[[pd.DataFrame, pd.DataFrame, Sequence[Station]], Measurements]] = {
    "tracking": Measured,
    "fixes": lambda table, *_: Fixes(table),
    "laser_ranges": lambda table, orientation, _: LaserRanges(table, orientation),
}
"""Makers of measurements from tables, the Earth's orientation and stations, by the table's schema."""


def read(files: Any, stations: Sequence[Station]) -> Measurements:
    """Read what fits of a job are made to: its `tracking`, measured by the stations or of `fixes`.

    Raises InputError where a table is missing or damaged.
    """
    orientation = read_table(files.earth_orientation, "earth_orientation")
    known = read_manoeuvres(files.tracking)
    return measurements(read_measured(files.tracking), orientation, stations, known)


def measurements(
    table: pd.DataFrame,
    orientation: pd.DataFrame,
    stations: Sequence[Station],
    manoeuvres: Sequence[Manoeuvre] = (),
) -> Measurements:
    """Return the measurements of a table `tracking`, by the stations, or of one that stands in its place.

    orientation: table `earth_orientation`
    manoeuvres: in the order of their times

    Raises InputError for another table.
    """
    measured = MEASUREMENTS[kinds.of_table(table).table](table, orientation, stations)
    return measured.restart_after_burns(manoeuvres)


def arcs(points: pd.DataFrame, *, length: float = ARC) -> pd.DataFrame:
    """Return the `fixes` table of points along an orbit, grouped into arcs.

    points: that table without its column `track`, in ascending order of t
    length: of an arc [s], counted from the epoch, so that more points change no other arc
    """
    numbers = pd.factorize(np.floor(points["t"].to_numpy() / length))[0]
    return points.assign(track=numbers)[SCHEMAS["fixes"].names]
