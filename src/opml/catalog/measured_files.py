"""Measurements of an object from its files: whether they fit a run, and what fits are made to."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.base.constants import HOUR
from opml.base.section import JobSettings
from opml.catalog import kinds
from opml.catalog.fit import fixes, laser_ranges, measured_tracks
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.first.first_orbit import TimedState
from opml.interop import crd, first_state, points_from_files, sinex, tdm
from opml.interop.object_ids import UNKNOWN, ObjectId, most_specific
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.points_from_files import FixSettings
from opml.orbits import manoeuvres
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.sheets import Rso, Station


class MeasurementSource(JobSettings):
    """Files of an object's measurements, and what else is known of them."""

    kind: str  # name of a kind
    files: list[str]
    options: Any  # of reading them
    satellite: str | None = None  # name or number, of several
    start: str = ""  # file of a state that the very first fits may start from, if any
    manoeuvres: Sequence[str] = ()  # UTC texts


@dataclass(frozen=True)
class Span:
    """The run: its epoch, UTC text, and its length [s]."""

    epoch: str
    duration: float


@dataclass(frozen=True)
class ObjectMeasurements:
    """Measurements of an object, and what its files tell of it."""

    tracking: pd.DataFrame  # the table, or `fixes` in its place
    manoeuvres: list[Manoeuvre]
    identity: ObjectId = UNKNOWN  # what its files tell of the object


def check(source: MeasurementSource, span: Span, stations: Mapping[str, Station]) -> None:
    """Raise InputError for files that do not fit the run, each other, or the stations there are, by name."""
    if source.kind == kinds.TRACKS.name:
        measured = tdm.measurements(source.files, epoch=span.epoch)
        measured_tracks.check(measured, stations, epoch=span.epoch, duration=span.duration)
    elif source.kind == kinds.FIXES.name:
        files = OrbitFiles(source.files, span.epoch, span.duration)
        points_from_files.check(files, source.options)
    else:
        options, points = source.options, crd.read(source.files, epoch=span.epoch)
        points = laser_ranges.of_run(points, span.duration, without=options.without)
        coordinates = sinex.read_coordinates(options.coordinates)
        sites = laser_ranges.Sites(coordinates, sinex.read_eccentricities(options.eccentricities))
        laser_ranges.positions(points, sites, epoch=span.epoch)


def read(
    source: MeasurementSource,
    span: Span,
    stations: Sequence[Station],
    orientation: pd.DataFrame,
    *,
    since: float,
) -> ObjectMeasurements:
    """Return what was measured of an object, of tracks or fixes.

    since: earlier measurements are left out, of fixes none [s]

    Raises InputError, naming file and line, where a file is missing or damaged.
    """
    known = manoeuvres.at_times(source.manoeuvres, epoch=span.epoch)
    if source.kind == kinds.TRACKS.name:
        measured = tdm.measurements(source.files, epoch=span.epoch, wanted=source.satellite)
        tracking = measured_tracks.tracks(measured[measured["t"] >= since], stations)
        started = [first_state.identity(source.start)] if source.start else []
        return ObjectMeasurements(tracking, known, most_specific([*started, tdm.identity(measured)]))
    options = FixSettings.model_validate(source.options)
    files = OrbitFiles(source.files, span.epoch, span.duration, source.satellite)
    points = points_from_files.read(files, orientation, options)
    tracking = fixes.arcs(points, length=HOUR * options.stretch_hours)
    identity, burns = points_from_files.identity_and_burns(files)
    return ObjectMeasurements(tracking, known + burns, identity)


def given_state(
    source: MeasurementSource, span: Span, rso: Rso, tracking: pd.DataFrame, gm: float
) -> TimedState | None:
    """Return the state that the very first fits may start from: of a file, or of the sheet's elements."""
    if source.start:
        return first_state.read(source.start, epoch=span.epoch, t=float(tracking["t"].iloc[0]))
    return first_orbit.of_sheet(rso, gm)
