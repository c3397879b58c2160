"""Positions that were measured, with velocities or without."""

from opml.catalog.kinds import MeasurementRequest
from opml.interop import points_from_files
from opml.interop.orbit_from_files import OrbitFiles


def check(request: MeasurementRequest) -> None:
    """Look at files of points: whether they fit the run and each other."""
    files = OrbitFiles(request.paths, request.epoch, request.duration)
    points_from_files.check(files, request.options)
