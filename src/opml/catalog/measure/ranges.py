"""Ranges that lasers measured, from stations in no sheet."""

from opml.catalog.fit import laser_ranges
from opml.catalog.kinds import MeasurementRequest
from opml.interop import crd, sinex


def check(asked: MeasurementRequest) -> None:
    """Look at normal points: whether they fit the run, and whether all their stations are known."""
    points, taking = crd.read(asked.paths, epoch=asked.epoch), asked.taking
    points = laser_ranges.of_run(points, asked.duration, without=taking.without)
    sites = laser_ranges.Sites(
        sinex.read_coordinates(taking.coordinates), sinex.read_eccentricities(taking.eccentricities)
    )
    laser_ranges.positions(points, sites, epoch=asked.epoch)
