"""Tracks that stations of the sheet measured."""

from opml.catalog.fit import measured_tracks
from opml.catalog.kinds import MeasurementRequest
from opml.interop import tdm


def check(asked: MeasurementRequest) -> None:
    """Look at messages of tracks: whether they fit the run, the stations and each other."""
    measured = tdm.measurements(asked.paths, epoch=asked.epoch)
    measured_tracks.check(measured, asked.stations, epoch=asked.epoch, duration=asked.duration)
