"""Two orbits compared with each other: how far apart in RSW, time by time, and how much a covariance holds.

    table = comparison.compare(comparison.read(["mine.oem"]), comparison.read(["truth.sp3"]))
    print(comparison.summary(table))

An orbit is an OEM, SP3, CPF, CSV of points, or mean elements flown by SGP4.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.stats import chi2

from opml.base.constants import DAY, HOUR
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions.approaches import FEWEST, LONGEST_STEP, STEP, Path, velocities_of
from opml.conjunctions.trajectories import EPOCH, covariances_at
from opml.environment import earth_orientation, nodes
from opml.interop import ccsds, fixes_csv, oem
from opml.interop.curves.orbit_curve import rotate_to_gcrf
from opml.interop.element_sets import histories
from opml.interop.element_sets.mean_elements import MOST_DAYS
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.interop.orbit_arcs import Arc, contents
from opml.interop.orbit_from_files import OrbitFiles, is_orbit, whole_arcs
from opml.orbits.elements import bent_rsw, rsw_rotation
from opml.orbits.rsw_covariance import mahalanobis

FLOWN_DAYS = 7.0  # time over which two orbits are compared that are both of mean elements [d]
LEVELS = (0.5, 0.9)  # shares that the ellipsoids of a covariance hold which a summary counts
MOST_ROWS = 14  # largest number of rows of a summary
_SPACINGS = (0.1, 0.5, 1.0, 3.0, 6.0, 12.0, 24.0, 72.0, 240.0, 720.0, 2400.0)  # [h]
_SAME = 1e-5  # [s]
_OTHER_UNIT = 0.5  # of most ways between positions that velocities miss by more

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Stretch:
    """States of an orbit without a gap.

    covariance_t, covariances: (m,) [s] and (m, 3, 3) of positions in RSW [m2]
    """

    name: str
    t: np.ndarray  # (n,) ascending [s since EPOCH]
    states: np.ndarray  # (n, 6) in GCRF [m, m/s], velocities NaN where unknown
    covariance_t: np.ndarray = field(default_factory=lambda: np.empty(0))
    covariances: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 3)))

    @cached_property
    def _path(self) -> Path:
        return Path(self.name, self.t, self.states)

    def holds(self, t: np.ndarray) -> np.ndarray:
        """Return whether states follow at times (n,): at its own, and between them where they are many."""
        if len(self.t) >= FEWEST:
            return np.asarray((t >= self.t[0] - _SAME) & (t <= self.t[-1] + _SAME))
        return np.asarray(np.abs(t[:, None] - self.t).min(axis=1) <= _SAME)

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return states (n, 6) at times (n,) that it holds."""
        if len(self.t) >= FEWEST:
            return self._path.at(t)
        return np.asarray(self.states[np.abs(t[:, None] - self.t).argmin(axis=1)])


@dataclass(frozen=True, eq=False)
class States:
    """An orbit of states, interpolated between those that are at most five minutes apart."""

    source: str  # the file, the first of several
    stretches: Sequence[Stretch]  # in the order of time; where they overlap the later one counts
    is_flown: bool = False  # whether states follow from mean elements at any time
    identity: ObjectId = UNKNOWN  # of the object

    @cached_property
    def t(self) -> np.ndarray:
        """Return the times (n,) of all states [s since EPOCH]."""
        return np.unique(np.concatenate([one.t for one in self.stretches]))

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return GCRF states (n, 6) [m, m/s] at times (n,), NaN where nothing is known."""
        states = np.full((len(t), 6), np.nan)
        for one in self.stretches:
            held = one.holds(t)
            states[held] = one.at(t[held])
        return states

    def covariances(self, t: np.ndarray) -> np.ndarray:
        """Return covariances (n, 3, 3) of positions in RSW [m2] at times (n,), NaN where none is known."""
        found = np.full((len(t), 3, 3), np.nan)
        for one in self.stretches:
            held = one.holds(t)
            found[held] = covariances_at(one.covariance_t, one.covariances, t[held])
        return found


@dataclass(frozen=True, eq=False)
class Sets:
    """An orbit of mean elements: at each time the set flies, by SGP4, whose epoch is nearest."""

    source: str
    sets: pd.DataFrame
    identity: ObjectId
    is_flown: bool = True

    @property
    def t(self) -> np.ndarray:
        """Return the epochs (n,) [s since EPOCH]."""
        return np.asarray(self.sets["t"])

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return states as `States.at`; a set flies 30 days at most."""
        states = np.full((len(t), 6), np.nan)
        nearest = np.searchsorted(0.5 * (self.t[1:] + self.t[:-1]), t)
        young = np.abs(t - self.t[nearest]) <= DAY * MOST_DAYS
        for row in np.unique(nearest[young]):
            near = young & (nearest == row)
            states[near] = histories.states_of(self.sets.iloc[row], epoch=EPOCH, t=t[near])
        return states

    def covariances(self, t: np.ndarray) -> np.ndarray:
        """Return covariances as `States.covariances`: sets have none."""
        return np.full((len(t), 3, 3), np.nan)


ComparedOrbit = States | Sets


def read(paths: Sequence[FilePath], wanted: str | None = None) -> ComparedOrbit:
    """Read an orbit of one object from files of one format, times from EPOCH on.

    wanted: name or number of the object in the files; None: they have only one

    Raises InputError, naming file and line, as the readers of the formats do.
    """
    content = contents(paths[0])
    if is_orbit(content):
        return _of_orbit(paths, wanted, is_message=oem.matches(content))
    if not fixes_csv.matches(content):
        return _of_sets(paths, wanted)
    return _of_arcs(
        [fixes_csv.read(path, contents(path), epoch=EPOCH, satellite=wanted)[0] for path in paths]
    )


def compare(ours: ComparedOrbit, other: ComparedOrbit) -> pd.DataFrame:
    """Return the table `comparison`: ours less the other, at the times of the other's states.

    Where the other has mean elements, or ours knows nothing between its own states, the times are those of
    ours; where both have mean elements, every minute of a week from our newest set on.
    Along the track the distance is an arc, so that a satellite far ahead is not below. Objects that are known
    to be two are logged. Raises InputError where both know nothing of the same time.
    """
    if ours.identity.is_another(other.identity):
        _log.warning("compare: expected orbits of one object, got %s and %s", ours.identity, other.identity)
    t = _times(ours, other)
    mine, theirs = ours.at(t), other.at(t)
    both = np.isfinite(mine[:, :3]).all(axis=1) & np.isfinite(theirs[:, :3]).all(axis=1)
    theirs[:, 3:] = np.where(np.isfinite(theirs[:, 3:]), theirs[:, 3:], mine[:, 3:])
    both &= np.isfinite(theirs[:, 3:]).all(axis=1)
    if not both.any():
        spans = " and ".join(_span(one) for one in (ours, other))
        raise InputError(f"compare: expected two orbits of the same time, got {spans}")
    t, mine, theirs = t[both], mine[both], theirs[both]
    apart = bent_rsw(mine[:, :3], theirs)
    covariances = ours.covariances(t)
    known = np.isfinite(covariances).all(axis=(1, 2))
    share = np.full(len(t), np.nan)
    share[known] = chi2.cdf(mahalanobis(apart[known], covariances[known]), 3)
    sigma = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    return pd.DataFrame(
        {
            "utc": ccsds.utc_texts(EPOCH, t),
            "hours": (t - t[0]) / HOUR,
            **dict(zip(("r", "s", "w"), apart.T, strict=True)),
            "distance": np.linalg.norm(mine[:, :3] - theirs[:, :3], axis=1),
            **dict(zip(("sigma_r", "sigma_s", "sigma_w"), sigma.T, strict=True)),
            "ellipsoid": share,
        }
    )


def summary(table: pd.DataFrame) -> str:
    """Return root mean squares by time as aligned text, and how much lies inside the covariance."""
    hours = table["hours"]
    spacing = next((one for one in _SPACINGS if hours.iloc[-1] < MOST_ROWS * one), _SPACINGS[-1])
    last = max(np.ceil(hours.iloc[-1] / spacing) - 1.0, 0.0)
    begins = spacing * np.minimum(np.floor(hours / spacing), last)
    columns = ["r", "s", "w", "distance", "sigma_r", "sigma_s", "sigma_w"]
    rows = np.sqrt((table[columns] ** 2).groupby(begins).mean())
    rows.insert(0, "times", table.groupby(begins).size())
    rows.insert(1, "from_h", rows.index)
    rows = rows.dropna(axis="columns", how="all").rename(columns={name: f"{name}_m" for name in columns})
    formats = dict.fromkeys(rows.columns, "{:.0f}".format) | {"from_h": "{:g}".format}
    lines = [
        f"root mean squares from {table['utc'].iloc[0]} UTC on",
        rows.to_string(index=False, formatters=formats, na_rep="-"),
    ]
    inside = table["ellipsoid"].dropna()
    if len(inside):
        shares = ", ".join(
            f"{100.0 * np.mean(inside <= level):.0f} % inside its {100.0 * level:.0f} %" for level in LEVELS
        )
        lines.append(f"covariance: {shares}")
    return "\n".join(lines)


def _times(ours: ComparedOrbit, other: ComparedOrbit) -> np.ndarray:
    if ours.is_flown and other.is_flown:
        return np.arange(ours.t[-1], ours.t[-1] + DAY * FLOWN_DAYS, STEP)
    if other.is_flown or not np.isfinite(ours.at(other.t)).any():
        return ours.t
    return other.t


def _span(orbit: ComparedOrbit) -> str:
    begin, end = ccsds.utc_texts(EPOCH, orbit.t[[0, -1]])
    return f"{orbit.source} from {begin} to {end}"


def _of_orbit(paths: Sequence[FilePath], wanted: str | None, *, is_message: bool) -> States:
    arcs = whole_arcs(OrbitFiles(paths, EPOCH, np.inf, wanted))
    if not is_message or arcs[0].frame == "ITRF":
        return _of_arcs(arcs)
    begins = {(arc.satellite, arc.t[0]) for arc in arcs}
    segments = [
        one for path in paths for one in oem.read(path, epoch=EPOCH) if (one.name, one.t[0]) in begins
    ]
    stretches = [stretch for one in segments for stretch in stretches_of(one)]
    return States(str(paths[0]), stretches, identity=segments[0].identity)


def _of_arcs(arcs: Sequence[Arc]) -> States:
    ordered = sorted(arcs, key=lambda arc: float(arc.t[0]))
    stretches = [one for arc in ordered for one in _stretches(str(arc.path), *_in_gcrf(_in_one_unit(arc)))]
    return States(str(arcs[0].path), stretches, identity=arcs[0].identity)


def _in_one_unit(arc: Arc) -> Arc:
    """Return an arc, without its velocities where their unit is another, as in SP3 files of CNES."""
    moved = np.diff(arc.positions, axis=0)
    by_velocity = 0.5 * np.diff(arc.t)[:, None] * (arc.velocities[1:] + arc.velocities[:-1])
    ways, misses = (np.linalg.norm(one, axis=1) for one in (moved, moved - by_velocity))
    if np.count_nonzero(misses > _OTHER_UNIT * ways) <= len(ways) / 2:
        return arc
    _log.warning("%s: velocities of another unit passed over", arc.path)
    return arc.without_velocities()


def stretches_of(segment: oem.Segment) -> list[Stretch]:
    """Return the stretches of a segment, with covariances of positions in RSW."""
    stretches = _stretches(segment.name, segment.t, segment.states)
    t, covariances = segment.covariance_t, segment.covariances[:, :3, :3]
    if segment.covariance_frame == "GCRF" and len(t):
        states = States(segment.name, stretches).at(t)
        known = np.isfinite(states).all(axis=1)
        turns = rsw_rotation(states[known])
        t, covariances = t[known], turns @ covariances[known] @ turns.transpose(0, 2, 1)
    return [replace(one, covariance_t=t, covariances=covariances) for one in stretches]


def _in_gcrf(arc: Arc) -> tuple[np.ndarray, np.ndarray]:
    """Return times and GCRF states of an arc."""
    (begin,) = ccsds.utc_texts(EPOCH, arc.t[:1])
    hours = nodes(begin, float(arc.t[-1] - arc.t[0]))
    orientation = earth_orientation.tabulate(begin, hours)
    return arc.t, rotate_to_gcrf(replace(arc, t=arc.t - arc.t[0]), orientation)


def _stretches(name: str, t: np.ndarray, states: np.ndarray) -> list[Stretch]:
    """Return stretches of ascending times (n,); positions without velocities get them where they are many."""
    parts = np.split(np.arange(len(t)), np.flatnonzero(np.diff(t) > LONGEST_STEP + _SAME) + 1)
    return [Stretch(name, t[part], _with_velocities(t[part], states[part])) for part in parts]


def _with_velocities(t: np.ndarray, states: np.ndarray) -> np.ndarray:
    if np.isfinite(states).all() or len(t) < FEWEST:
        return states
    return np.hstack([states[:, :3], velocities_of(t, states[:, :3])])


def _of_sets(paths: Sequence[FilePath], wanted: str | None) -> Sets:
    history = histories.read(paths, epoch=EPOCH)
    sets = histories.of_object(history.sets, _number(paths[0], history, wanted))
    return Sets(str(paths[0]), sets, history.objects[sets["number"].iloc[0]])


def _number(path: FilePath, history: histories.History, wanted: str | None) -> int | None:
    """Return the catalogue number of what is wanted: a number, a name or a designator."""
    if wanted is None:
        return None
    for number, one in history.objects.items():
        if one.is_called(wanted):
            return number
    objects = ", ".join(str(one) for one in [*history.objects.values()][:5])
    raise InputError(f"{path}: expected object {wanted}, got {objects}")
