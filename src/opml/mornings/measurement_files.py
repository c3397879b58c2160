"""What was measured of an object, from its files: tracks, fixes or mean elements."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import pandas as pd

from opml.base.constants import HOUR
from opml.catalog.fit import fixes, measured_tracks
from opml.catalog.fit.first import first_orbit
from opml.catalog.fit.first.first_orbit import TimedState
from opml.dynamics import shared_blocks
from opml.interop import first_state, points_from_files, tdm
from opml.interop.element_sets import burns_in_sets, histories, measured_sets
from opml.interop.element_sets.histories import History
from opml.interop.element_sets.measured_sets import HistoryTaking
from opml.interop.object_ids import UNKNOWN, ObjectId, most_specific
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.points_from_files import FixTaking
from opml.mornings.watched_object import Sgp4
from opml.orbits import manoeuvres
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.sheets import Rso, Station


@dataclass(frozen=True)
class MeasurementSource:
    """Where the measurements of an object are.

    options: how fixes or mean elements are taken; of fixes and tracks also the satellite, of several
    read_sets: `histories.read`, or what reads files once for all objects in them
    """

    kind: str  # tracks, fixes or elements
    files: list[str]  # of them
    options: Mapping[str, Any]
    start: str = ""  # file of a state that the very first fits may start from, if any
    manoeuvres: Sequence[str] = ()  # UTC texts
    read_sets: Callable[..., History] = histories.read


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
    sgp4: Sgp4 | None = None  # the prediction of the public sets, where mean elements were taken


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
        satellite = source.options.get("satellite")
        found = tdm.measurements(source.files, epoch=span.epoch, wanted=satellite)
        tracking = measured_tracks.tracks(found[found["t"] >= since], stations)
        started = [first_state.identity(source.start)] if source.start else []
        return ObjectMeasurements(tracking, known, most_specific([*started, tdm.identity(found)]))
    if source.kind == "fixes":
        options = FixTaking.model_validate(source.options)
        files = OrbitFiles(source.files, span.epoch, span.duration, options.satellite)
        points = points_from_files.read(files, orientation, options.sampling)
        tracking = fixes.arcs(points, length=HOUR * options.stretch_hours)
        identity, burns = points_from_files.identity_and_burns(files)
        return ObjectMeasurements(tracking, known + burns, identity)
    asked = HistoryTaking.model_validate(source.options)
    history = source.read_sets(
        tuple(source.files), epoch=span.epoch, leave_out_damaged=asked.leave_out_damaged
    )
    return _of_elements(history, asked, span, known, since=since)


def _of_elements(
    history: History, options: HistoryTaking, span: Span, known: list[Manoeuvre], *, since: float
) -> ObjectMeasurements:
    """Return what mean elements measured; the manoeuvres are with those that they show, if asked for."""
    ours = histories.of_object(history.sets, options.number)
    sets, identity = measured_sets.of_run(ours, span.duration), history.objects[int(ours["number"].iloc[0])]
    known = burns_in_sets.manoeuvres_of(sets, known, epoch=span.epoch, find=options.find_manoeuvres)
    found = measured_sets.measured(
        sets,
        # On the raster arcs of several objects share blocks.
        replace(options.of_sets, raster=shared_blocks.STEP, since=since),
        epoch=span.epoch,
        duration=span.duration,
        manoeuvres=known,
    )
    tracking = fixes.of_sets(found.epochs, found.points, known=found.known)
    return ObjectMeasurements(tracking, known, identity, Sgp4(sets, span.epoch))


def given_state(
    source: MeasurementSource, span: Span, rso: Rso, tracking: pd.DataFrame, gm: float
) -> TimedState | None:
    """Return the state that the very first fits may start from: of a file, or of the sheet's elements."""
    if source.start:
        return first_state.read(source.start, epoch=span.epoch, t=float(tracking["t"].iloc[0]))
    return first_orbit.of_sheet(rso, gm)
