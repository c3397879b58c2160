"""Ranges that lasers measured, from stations in no sheet."""

from opml.catalog.fit import laser_ranges
from opml.catalog.kinds import MeasurementRequest
from opml.interop import crd, sinex


def check(request: MeasurementRequest) -> None:
    """Look at normal points: whether they fit the run, and whether all their stations are known."""
    points, options = crd.read(request.paths, epoch=request.epoch), request.options
    points = laser_ranges.of_run(points, request.duration, without=options.without)
    sites = laser_ranges.Sites(
        sinex.read_coordinates(options.coordinates), sinex.read_eccentricities(options.eccentricities)
    )
    laser_ranges.positions(points, sites, epoch=request.epoch)
