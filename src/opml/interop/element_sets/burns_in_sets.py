"""Burns in a history of mean elements: where its sets do not follow from those before them.

SGP4 brings the mean orbit of a set to the epoch of a later one. Where its size or its plane is then off by
many times what is usual between such sets, and the next set agrees with the new orbit, the object burned. The
burn is known with that next set, and no set after it counts. Its time is the epoch of the first set that is
off: sets are made of tracks up to some hours after their epochs.
"""

import logging
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from sgp4.api import Satrec

from opml.base.constants import DAY
from opml.interop import ccsds
from opml.orbits.manoeuvres import Manoeuvre

OFF = 5.0  # how many standard deviations two sets are apart between which a burn lies

_SETTLING = 5
"""Sets after a burn that may be twice as far apart: some are made of tracks from both sides of it."""

_FEWEST = 8  # differences that make a past
_RECENT = 40  # newest differences that count
_ALWAYS = 0.5 * DAY  # gap in which drag parts two sets as much as the noise of their fits does [s]
_UNCLEAR = 5  # sets in a row that follow from none, after which a new past begins
_SIGMAS = 1.15  # standard deviations within which three quarters of normal differences lie
_EARTH_RADIUS = 6378.135e3  # WGS 72, the unit of SGP4's lengths [m]
_MINUTE = 60.0

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class KnownSet:
    """A set of mean elements: its epoch, when it was made [s], and what SGP4 propagates."""

    t: float
    made: float
    satellite: Satrec


@dataclass
class _Past:
    """Differences between sets that followed from each other."""

    gaps: list[float] = field(default_factory=list)  # between the epochs of two sets [s]
    sizes: list[np.ndarray] = field(default_factory=list)  # of the differences (2,) [m]
    since: int = _SETTLING  # number of sets since the last burn

    def follows(self, earlier: KnownSet, later: KnownSet) -> bool:
        """Return whether a set follows from an earlier one; their difference counts from then on if so."""
        gap, size = later.t - earlier.t, _difference(earlier, later)
        if not np.isfinite(size).all() or not (size <= self._most(gap)).all():
            return False
        self.gaps.append(gap)
        self.sizes.append(size)
        self.since += 1
        return True

    def _most(self, gap: float) -> np.ndarray:
        """Return how large differences (2,) across a gap may be [m].

        Drag lets them grow with it, but two sets a minute apart are apart, too.
        """
        recent, gaps = self.sizes[-_RECENT:], self.gaps[-_RECENT:]
        if len(recent) < _FEWEST:
            return np.full(2, np.inf)
        sigma = np.quantile(recent, 0.75, axis=0) / _SIGMAS
        grown = (gap + _ALWAYS) / (float(np.median(gaps)) + _ALWAYS)
        growth = max(1.0, grown) * (2.0 if self.since < _SETTLING else 1.0)
        return OFF * growth * sigma


def burns_among(sets: Iterable[KnownSet], *, epoch: str) -> list[Manoeuvre]:
    """Return the burns that sets of one object in order of time show; each is logged."""
    burns, past = [], _Past()
    followed: KnownSet | None = None
    off: list[KnownSet] = []  # those after it, which do not follow from it
    for one in sets:
        if followed is None or past.follows(followed, one):
            followed, off = one, []
        elif len(off) == _UNCLEAR or (off and past.follows(off[-1], one)):
            burns.append(Manoeuvre(off[0].t, one.made))
            begin, end, known = ccsds.utc_texts(epoch, np.array([followed.t, off[0].t, one.t]))
            _log.debug("a burn between %s and %s, found by the set of %s", begin, end, known)
            past = _Past() if len(off) == _UNCLEAR else past
            past.since = 0
            followed, off = one, []
        else:
            off.append(one)
    return burns


def _difference(earlier: KnownSet, later: KnownSet) -> np.ndarray:
    """Return how far two mean orbits are apart at the later epoch: semi-major axes and planes (2,) [m]."""
    (a, i, node), (other_a, other_i, other_node) = (
        _mean_orbit(one.satellite, later.t - one.t) for one in (later, earlier)
    )
    turn = np.remainder(node - other_node + np.pi, 2.0 * np.pi) - np.pi
    tilt = np.hypot(i - other_i, np.sin(i) * turn)
    return _EARTH_RADIUS * np.array([abs(a - other_a), a * tilt])


def _mean_orbit(satellite: Satrec, after: float) -> tuple[float, float, float]:
    """Return mean semi-major axis [Earth radii], inclination and node [rad] some time [s] after the epoch.

    All are NaN where SGP4 fails.
    """
    error, _, _ = satellite.sgp4_tsince(after / _MINUTE)
    return (satellite.am, satellite.im, satellite.Om) if error == 0 else (np.nan, np.nan, np.nan)
