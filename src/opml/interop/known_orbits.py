"""An orbit as files have it, whatever their format: states in GCRF at any time, covariances where known.

    orbit = known_orbits.read(["mine.oem"])
    orbit.state("2019-09-16T00:00:00")

Files are of any format of orbits, tables of opml with states, or mean elements, which SGP4 propagates.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.arrays import read_only
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.environment import earth_orientation, nodes
from opml.interop import ccsds, formats, object_ids, oem
from opml.interop.curves.orbit_curve import rotate_to_gcrf
from opml.interop.element_sets import known_sets, mean_elements
from opml.interop.element_sets.burns_in_sets import KnownSet
from opml.interop.element_sets.mean_elements import MOST_DAYS
from opml.interop.ephemeris import EPOCH, LONGEST_STEP, Ephemeris, with_velocities
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.interop.orbit_arcs import EVERY, Arc, contents
from opml.interop.orbit_from_files import OrbitFiles, arcs_of_files
from opml.interop.predicted_orbit import PredictedOrbit
from opml.tables import STATE, read_kind, read_metadata, read_table

_SAME = 1e-5  # [s]


@dataclass(frozen=True, eq=False, repr=False)
class KnownOrbit:
    """An orbit of one object, interpolated between states that are at most five minutes from each other.

    source: the file, the first of several; parts: in the order of time; where they overlap the later one
    counts; identity: of the object
    """

    source: str
    parts: Sequence[Ephemeris]
    identity: ObjectId = UNKNOWN

    def __repr__(self) -> str:
        """Return the object, and from when to when it is known, in two lines."""
        begin, end = ccsds.utc_texts(EPOCH, self.t[[0, -1]])
        kind = "states" if self.parts else "sets"
        return f"<{self.identity or self.source}, {len(self.t)} {kind}\n {begin} to {end} UTC>"

    @cached_property
    def t(self) -> np.ndarray:
        """Times (n,) of its states, or epochs of its mean elements [s since EPOCH]."""
        return read_only(np.unique(np.concatenate([one.t for one in self.parts])))

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return GCRF states (n, 6) [m, m/s] at times (n,) [s since EPOCH], NaN where nothing is known."""
        states = np.full((len(t), 6), np.nan)
        for one in self.parts:
            held = one.holds(t)
            states[held] = one.at(t[held])
        return states

    def covariances(self, t: np.ndarray) -> np.ndarray:
        """Return covariances (n, 6, 6) in RSW [m, m/s] at times (n,), NaN where none is known."""
        matrices = np.full((len(t), 6, 6), np.nan)
        for one in self.parts:
            held = one.holds(t)
            matrices[held] = one.covariances_at(t[held])
        return matrices

    def state(self, time: epochs.Time) -> np.ndarray:
        """Return the GCRF state (6,) [m, m/s] at a time (UTC), NaN where nothing is known."""
        return self.at(epochs.seconds_to(EPOCH, time))[0]

    def covariance(self, time: epochs.Time) -> np.ndarray:
        """Return the covariance (6, 6) in RSW [m, m/s] at a time (UTC), NaN where none is known."""
        return self.covariances(epochs.seconds_to(EPOCH, time))[0]

    def to_pandas(self) -> pd.DataFrame:
        """Return its states as a table: utc, GCRF state [m, m/s], sigma_r, sigma_s, sigma_w [m]."""
        states = pd.DataFrame(self.at(self.t), columns=STATE)
        states.insert(0, "utc", ccsds.utc_texts(EPOCH, self.t))
        sigmas = np.sqrt(np.diagonal(self.covariances(self.t), axis1=1, axis2=2)[:, :3])
        return states.assign(**dict(zip(("sigma_r", "sigma_s", "sigma_w"), sigmas.T, strict=True)))


@dataclass(frozen=True, eq=False, repr=False)
class Sets(KnownOrbit):
    """An orbit of mean elements: at each time the set is propagated, by SGP4, whose epoch is nearest."""

    sets: Sequence[KnownSet] = ()  # by epoch, times since EPOCH

    @cached_property
    def t(self) -> np.ndarray:
        """Epochs (n,) [s since EPOCH]."""
        return read_only(np.array([one.t for one in self.sets]))

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return states as `KnownOrbit.at`; a set is propagated 30 days at most."""
        states = np.full((len(t), 6), np.nan)
        nearest = np.searchsorted(0.5 * (self.t[1:] + self.t[:-1]), t)
        young = np.abs(t - self.t[nearest]) <= DAY * MOST_DAYS
        for row in np.unique(nearest[young]):
            near = young & (nearest == row)
            states[near] = mean_elements.states(self.sets[row].satellite, epoch=EPOCH, t=t[near])
        return states


def read(paths: Sequence[FilePath], wanted: str | None = None) -> KnownOrbit:
    """Read an orbit of one object from files of one format, times from EPOCH on.

    wanted: name or number of the object in the files; None: they have only one

    Raises InputError, naming file and line, as the readers of the formats do.
    """
    paths = list(dict.fromkeys(paths))
    kind = formats.kind_of(paths[0], formats.TABLE, formats.ORBIT, formats.ELEMENTS)
    if kind == formats.ELEMENTS:
        history = known_sets.of_object(paths, wanted)
        return Sets(str(paths[0]), (), known_sets.identity(history[-1]), known_sets.since(EPOCH, history))
    if kind == formats.TABLE:
        return _of_tables(paths)
    arcs = arcs_of_files(OrbitFiles(paths, EPOCH, np.inf, wanted))
    by_file = [replace(_in_gcrf(arc, EPOCH), name=str(arc.path)) for arc in arcs]
    parts = [one for segment in by_file for one in parts_of(segment)]
    return KnownOrbit(str(paths[0]), parts, arcs[0].identity)


def segments(path: FilePath, *, epoch: str) -> list[Ephemeris]:
    """Read the ephemerides of all objects in a file, in GCRF, velocities NaN where it has none.

    epoch: from which their times count

    Raises InputError, naming file and line, as the reader of its format does, and for no orbit.
    """
    arcs = formats.read(path, contents(path), formats.ORBIT, epoch=epoch, satellite=EVERY)
    newest = float(arcs[0].t[0])
    ephemerides = [_in_gcrf(arc, epoch) for arc in arcs]
    return [replace(one, known=newest) if one.known is None else one for one in ephemerides]


def _in_gcrf(arc: Arc, epoch: str) -> Ephemeris:
    """Return an arc in GCRF; epoch: from which its times count."""
    (begin,) = ccsds.utc_texts(epoch, arc.t[:1])
    orientation = earth_orientation.tabulate(begin, nodes(begin, float(arc.t[-1] - arc.t[0])))
    return Ephemeris(
        arc.satellite,
        arc.t,
        rotate_to_gcrf(replace(arc, t=arc.t - arc.t[0]), orientation),
        arc.covariance_t,
        arc.covariances,
        arc.covariance_frame,
        identity=arc.identity,
        known=arc.known,
        density=arc.density,
    )


def of(orbit: KnownOrbit | PredictedOrbit) -> KnownOrbit:
    """Return an orbit that was read, or a prediction as one. Raises InputError for what is neither."""
    if isinstance(orbit, PredictedOrbit):
        since = epochs.seconds_between(EPOCH, orbit.date)
        return KnownOrbit(orbit.way, parts_of(orbit.ephemeris.shifted(since)), orbit.identity)
    if not isinstance(orbit, KnownOrbit):
        raise InputError(f"compare: expected orbits or predictions, got {type(orbit).__name__}")
    return orbit


def _of_tables(paths: Sequence[FilePath]) -> KnownOrbit:
    """Return the orbit of tables with states; raise InputError for another table."""
    parts, identity = [], object_ids.of_tables(paths, name="")
    for path in paths:
        if (kind := read_kind(path)) not in oem.SEGMENTS:
            raise InputError(f"{path}: expected a table of {', '.join(oem.SEGMENTS)}, got one of {kind}")
        since = epochs.seconds_between(EPOCH, read_metadata(path)["epoch"])
        for one in oem.segments_of(read_table(path, kind), kind, identity):
            parts += parts_of(one.shifted(since))
    return KnownOrbit(str(paths[0]), parts, identity)


def parts_of(ephemeris: Ephemeris) -> list[Ephemeris]:
    """Return the parts of an ephemeris without gaps, with covariances in RSW, times since EPOCH.

    Positions without velocities get them where they are many.
    """
    t, states = ephemeris.t, ephemeris.states
    rows = np.split(np.arange(len(t)), np.flatnonzero(np.diff(t) > LONGEST_STEP + _SAME) + 1)
    parts = [replace(ephemeris, t=t[part], states=with_velocities(t[part], states[part])) for part in rows]
    turned = ephemeris.in_rsw(KnownOrbit(ephemeris.name, parts).at)
    return [replace(turned, t=one.t, states=one.states) for one in parts]
