"""Positions that were measured, with velocities or without."""

from collections.abc import Sequence

import pandas as pd

from opml.catalog.fit.fixes import Fixes
from opml.catalog.fit.measurements import Measurements
from opml.catalog.kinds import Asked
from opml.interop import points_from_files
from opml.interop.orbit_from_files import OrbitFiles
from opml.orbits.sheets import Station


def check(asked: Asked) -> None:
    """Look at files of points: whether they fit the run and each other."""
    files = OrbitFiles(asked.paths, asked.epoch, asked.duration)
    points_from_files.check(files, points_from_files.Sampling(asked.taking.sigmas, asked.taking.every_s))


def measurements(
    table: pd.DataFrame, _orientation: pd.DataFrame, _stations: Sequence[Station]
) -> Measurements:
    """Return the measurements of a table `fixes`."""
    return Fixes(table)
