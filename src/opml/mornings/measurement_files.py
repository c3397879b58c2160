"""What was measured of an object, from its files: tracks or fixes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from opml.base.constants import HOUR
from opml.base.section import JobSettings
from opml.catalog.fit import fixes, measured_tracks
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.first.first_orbit import TimedState
from opml.interop import first_state, points_from_files, tdm
from opml.interop.object_ids import UNKNOWN, ObjectId, most_specific
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.points_from_files import FixSettings
from opml.orbits import manoeuvres
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.sheets import Rso, Station


class MeasurementSource(JobSettings):
    """Files of an object's measurements, and what else is known of them."""

    kind: str  # tracks or fixes
    files: list[str]
    options: dict[str, Any]  # of reading them
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
    """What was measured of an object."""

    tracking: pd.DataFrame  # the table, or `fixes` in its place
    manoeuvres: list[Manoeuvre]
    identity: ObjectId = UNKNOWN  # what its files tell of the object


def read(
    source: MeasurementSource,
    span: Span,
    stations: Sequence[Station],
    orientation: pd.DataFrame,
    *,
    since: float,
) -> ObjectMeasurements:
    """Return what was measured of an object.

    since: earlier measurements are left out, of fixes none [s]

    Raises InputError, naming file and line, where a file is missing or damaged.
    """
    known = manoeuvres.at_times(source.manoeuvres, epoch=span.epoch)
    if source.kind == "tracks":
        found = tdm.measurements(source.files, epoch=span.epoch, wanted=source.satellite)
        tracking = measured_tracks.tracks(found[found["t"] >= since], stations)
        started = [first_state.identity(source.start)] if source.start else []
        return ObjectMeasurements(tracking, known, most_specific([*started, tdm.identity(found)]))
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
