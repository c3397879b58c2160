"""Ranges that lasers measured, from stations in no sheet."""

from collections.abc import Sequence

import pandas as pd

from opml.catalog.fit import laser_ranges
from opml.catalog.fit.measurements import Measurements
from opml.catalog.kinds import Asked
from opml.interop import crd, sinex
from opml.orbits.sheets import Station


def check(asked: Asked) -> None:
    """Look at normal points: whether they fit the run, and whether all their stations are known."""
    points, taking = crd.read(asked.paths, epoch=asked.epoch), asked.taking
    points = laser_ranges.of_run(points, asked.duration, without=taking.without)
    sites = laser_ranges.Sites(
        sinex.read_coordinates(taking.coordinates), sinex.read_eccentricities(taking.eccentricities)
    )
    laser_ranges.positions(points, sites, epoch=asked.epoch)


def measurements(
    table: pd.DataFrame, orientation: pd.DataFrame, _stations: Sequence[Station]
) -> Measurements:
    """Return the measurements of a table `laser_ranges`."""
    return laser_ranges.LaserRanges(table, orientation)
