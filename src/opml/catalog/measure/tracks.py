"""Tracks that stations of the sheet measured."""

from collections.abc import Sequence

import pandas as pd

from opml.catalog.fit import measured_tracks
from opml.catalog.fit.measurements import Measurements
from opml.catalog.fit.sightings import Measured
from opml.catalog.kinds import Asked
from opml.interop import tdm
from opml.orbits.sheets import Station


def check(asked: Asked) -> None:
    """Look at messages of tracks: whether they fit the run, the stations and each other."""
    measured = tdm.measurements(asked.paths, epoch=asked.epoch)
    measured_tracks.check(measured, asked.stations, epoch=asked.epoch, duration=asked.duration)


def measurements(table: pd.DataFrame, orientation: pd.DataFrame, stations: Sequence[Station]) -> Measurements:
    """Return the measurements of a table `tracking`."""
    return Measured(table, orientation, stations)
