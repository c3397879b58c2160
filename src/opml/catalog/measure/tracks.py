"""Tracks that stations of the sheet measured."""

from opml.catalog.fit import measured_tracks
from opml.catalog.kinds import MeasurementRequest
from opml.interop import tdm


def check(request: MeasurementRequest) -> None:
    """Look at messages of tracks: whether they fit the run, the stations and each other."""
    measured = tdm.measurements(request.paths, epoch=request.epoch)
    measured_tracks.check(measured, request.stations, epoch=request.epoch, duration=request.duration)
