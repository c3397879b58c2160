"""Close approaches between ephemerides in files: OEM with covariances, and mean elements without.

opml screen ours.oem others/*.oem catalogue.tle --within 5 --radius 20
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import approaches, cdm
from opml.conjunctions.approaches import Path
from opml.conjunctions.conjunction import Conjunction, Participant
from opml.interop import ccsds, oem
from opml.interop.element_sets import histories
from opml.interop.orbit_arcs import contents
from opml.orbits.elements import rsw_rotation

EPOCH = "2000-01-01T12:00:00"
"""UTC text from which times of files count [s], to a microsecond."""


@dataclass(frozen=True, eq=False)
class Ephemeris:
    """Where an object is expected, and how surely.

    covariance_t: (m,) ascending [s]
    covariances: (m, 6, 6) in RSW [m, m/s]
    """

    path: Path
    covariance_t: np.ndarray = field(default_factory=lambda: np.empty(0))
    covariances: np.ndarray = field(default_factory=lambda: np.empty((0, 6, 6)))

    def shares_time(self, other: "Ephemeris") -> bool:
        """Return whether both are known at some time."""
        return bool(self.path.t[0] < other.path.t[-1] and other.path.t[0] < self.path.t[-1])

    def participant(self, t: float) -> Participant:
        """Return the object at a time [s], its covariance linear between those that are known, if any is."""
        covariance = None
        if len(self.covariance_t):
            after = min(max(int(np.searchsorted(self.covariance_t, t)), 1), len(self.covariance_t) - 1)
            before = max(after - 1, 0)
            step = max(self.covariance_t[after] - self.covariance_t[before], 1e-9)
            share = float(np.clip((t - self.covariance_t[before]) / step, 0.0, 1.0))
            covariance = (1.0 - share) * self.covariances[before] + share * self.covariances[after]
        return Participant(self.path.name, self.path.at(t), covariance)


def read(paths: Sequence[FilePath]) -> list[Ephemeris]:
    """Read the ephemerides in files: OEM, and mean elements over the span of the OEM.

    A segment of an OEM is an ephemeris of its own. Of an object with several sets of elements the newest
    before the middle of the span flies, by SGP4. Raises InputError, naming the file, for what cannot be read,
    and where no file is an OEM.
    """
    for path in paths:
        if cdm.matches(contents(path)):
            raise InputError(f"{path}: expected an ephemeris or mean elements, got a CDM: it is read alone")
    messages = [path for path in paths if oem.matches(contents(path))]
    known = [ephemeris for path in messages for ephemeris in _of_message(path)]
    if not known:
        raise InputError(f"{paths[0]}: expected an OEM among the files, got none")
    others = [path for path in paths if path not in messages]
    if not others:
        return known
    begin = min(ephemeris.path.t[0] for ephemeris in known)
    end = max(ephemeris.path.t[-1] for ephemeris in known)
    return known + _of_elements(others, begin, end)


def screen(ephemerides: Sequence[Ephemeris], *, within: float, radius: float) -> list[Conjunction]:
    """Return the close approaches of the first ephemeris's object and all others, in the order of time.

    within: largest distance [m]
    radius: sum of the radii of two objects [m]

    Ephemerides of one name are of one object, which does not meet itself. Raises InputError for a distance
    or a radius that is none, and where no other object shares time with the first.
    """
    for name, value in (("within", within), ("radius", radius)):
        if not 0.0 < value < math.inf:
            raise InputError(f"{name}: expected a length above 0, got {value:g} m")
    ours, *rest = ephemerides
    others = [ephemeris for ephemeris in rest if ephemeris.path.name != ours.path.name]
    if not others:
        raise InputError("conjunctions: expected ephemerides of another object, got none")
    others = [one for one in others if one.shares_time(ours)]
    if not others:
        begin, end = ccsds.utc_texts(EPOCH, ours.path.t[[0, -1]])
        raise InputError(f"conjunctions: expected another ephemeris from {begin} to {end}, got none")
    flown = [ours, *others]
    found = approaches.find([one.path for one in flown], within=within, first_alone=True)
    return [
        Conjunction(one.t, flown[one.first].participant(one.t), flown[one.second].participant(one.t), radius)
        for one in found
    ]


def _of_message(path: FilePath) -> list[Ephemeris]:
    segments = oem.read(path, epoch=EPOCH)
    try:
        return [_of_segment(segment) for segment in segments]
    except InputError as reason:
        raise InputError(f"{path}: {reason}") from None


def _of_segment(segment: oem.Segment) -> Ephemeris:
    path = Path(segment.name, segment.t, segment.states)
    covariances = segment.covariances
    if segment.covariance_frame == "GCRF" and len(covariances):
        turns = np.kron(np.eye(2), rsw_rotation(np.array([path.at(t) for t in segment.covariance_t])))
        covariances = turns @ covariances @ turns.transpose(0, 2, 1)
    return Ephemeris(path, segment.covariance_t, covariances)


def _of_elements(paths: Sequence[FilePath], begin: float, end: float) -> list[Ephemeris]:
    t = np.arange(begin, end + approaches.STEP, approaches.STEP)
    sets = histories.read(paths, epoch=EPOCH).sets
    flown = []
    for number, history in sets.groupby("number"):
        known = histories.newest_before(history.reset_index(drop=True), 0.5 * (begin + end))
        row = history.iloc[0 if known is None else known]
        states = histories.states_of(row, epoch=EPOCH, t=t)
        if np.isfinite(states).all():
            flown.append(Ephemeris(Path(str(number), t, states)))
    return flown
