"""Mean elements fitted to an orbit: the TLEs that a catalogue would have issued from noisy positions of it.

    opml elements swarm/*.sp3.gz --every 12 --span 3 --noise 30 --number 99999 > sets.tle

SGP4 is fitted by least squares to the positions of some days before each epoch: mean motion, eccentricity,
angles and B*. What the fit leaves is mostly SGP4's own error.
"""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import least_squares
from sgp4.api import Satrec

from opml.base import seeds
from opml.base.constants import DAY, EARTH_GM, HOUR
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds, truth_from_orbit
from opml.interop.element_sets import tle
from opml.interop.element_sets.element_set import satellite
from opml.interop.element_sets.teme import teme_to_gcrf
from opml.interop.orbit_from_files import OrbitFiles, read_arcs
from opml.orbits.elements import coe_from_cartesian, mean_from_true_anomaly
from opml.tables import STATE

CADENCE = 120.0
"""Time between the positions that are fitted [s]."""

_FIRST_ARC = 0.2 * DAY
"""Length of the arc [s] that the osculating elements are good enough to start on."""

_LEAST = 0.5  # part of the positions of a span that must be there
_MINUTE = 60.0
_EVER = ("1972-01-01T00:00:00", 130 * 366 * DAY)  # every orbit that a file may hold
_LOST = 1e6  # residual [km] where SGP4 fails

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class SetPlan:
    """What sets are made of an orbit.

    every: time between their epochs [s]
    span: time before each epoch whose positions are fitted [s]
    noise: standard deviation of each coordinate of the positions [m]
    seed: of the noise
    number: catalogue number of the sets
    """

    every: float
    span: float
    noise: float
    seed: int
    number: int

    def __post_init__(self) -> None:
        """Raise InputError for a time that is too short, a negative noise, and a number that no TLE has."""
        tle.check_number(self.number)
        for name, least in (("every", CADENCE), ("span", HOUR)):
            if not least <= getattr(self, name) < math.inf:
                raise InputError(f"{name}: expected {least:g} s or more, got {getattr(self, name):g} s")
        if not 0.0 <= self.noise < math.inf:
            raise InputError(f"noise: expected a standard deviation [m], got {self.noise:g}")


@dataclass(frozen=True)
class SetFit:
    """A set that was fitted, and the root mean square distance of the positions from it [m]."""

    satellite: Satrec
    rms: float


def from_files(paths: Sequence[FilePath], plan: SetPlan, *, name: str | None = None) -> list[SetFit]:
    """Return the sets of an orbit in files, in SP3, CPF or OEM.

    name: name or id of the satellite in the files; None: the files have only one

    Raises InputError as `truth_from_orbit.truth` does, and for an orbit that is too short.
    """
    epoch, duration = _EVER
    arcs = read_arcs(OrbitFiles(paths, epoch, duration, name))
    first, last = min(arc.t[0] for arc in arcs), max(arc.t[-1] for arc in arcs)
    (epoch,) = ccsds.utc_texts(epoch, np.array([math.ceil(first)]))
    files = OrbitFiles(paths, epoch, float(last - math.ceil(first)), name)
    orbit, _ = truth_from_orbit.truth(files, step=CADENCE)
    fits = list(from_orbit(orbit, plan, epoch=epoch))
    if not fits:
        expected = f"an orbit without gaps for longer than {plan.span / DAY:g} days"
        raise InputError(f"{paths[0]}: expected {expected}, got {files.duration / DAY:.3g} days")
    return fits


def as_tles(fits: Sequence[SetFit], plan: SetPlan) -> str:
    """Return the lines of sets as TLEs."""
    return "\n".join(line for one in fits for line in tle.lines(one.satellite, plan.number))


def fit_summary(fits: Sequence[SetFit]) -> str:
    """Return a line that tells how far the positions are from sets."""
    rms = [one.rms for one in fits]
    return f"{len(fits)} sets, {np.median(rms):.0f} m rms from the positions, at most {max(rms):.0f} m"


def from_orbit(orbit: pd.DataFrame, plan: SetPlan, *, epoch: str) -> Iterator[SetFit]:
    """Yield the sets of an orbit; an epoch with too few positions before it has none, and is logged.

    orbit: columns of the table `truth`, a row each CADENCE
    epoch: UTC text
    """
    t, states = orbit["t"].to_numpy(), orbit[STATE].to_numpy()
    noise = plan.noise * seeds.derive(plan.seed, "element sets").normal(size=(len(t), 3))
    positions, velocities = in_teme(states + np.pad(noise, ((0, 0), (0, 3))), epoch, t)
    first_arc = min(plan.span, _FIRST_ARC)
    for end in np.arange(t[0] + plan.span, t[-1] + 0.5 * CADENCE, plan.every):
        rows = np.flatnonzero((t > end - plan.span - 0.5 * CADENCE) & (t < end + 0.5 * CADENCE))
        recent = np.count_nonzero(t[rows] > end - first_arc)
        if len(rows) < _LEAST * plan.span / CADENCE or recent < _LEAST * first_arc / CADENCE:
            _log.warning("no set at %.0f s: too few positions before it", end)
            continue
        known = np.concatenate([positions[rows[-1]], velocities[rows[-1]]])
        yield fit(t[rows], positions[rows], at=t[rows[-1]], known=known, epoch=epoch)


def in_teme(states: np.ndarray, epoch: str, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and velocities (n, 3) in TEME [km, km/s] of states (n, 6) in GCRF [m, m/s].

    epoch: UTC text
    t: (n,) [s since `epoch`]
    """
    turns = teme_to_gcrf(epoch, t)
    positions, velocities = (
        np.einsum("nji,nj->ni", turns, part) / 1e3 for part in (states[:, :3], states[:, 3:])
    )
    return positions, velocities


def fit(t: np.ndarray, positions: np.ndarray, *, at: float, known: np.ndarray, epoch: str) -> SetFit:
    """Return the set that comes nearest to positions.

    t: (n,) [s since `epoch`], ascending
    positions: (n, 3) in TEME [km]
    at: epoch of the set, the first or the last time [s]
    known: (6,) state then in TEME, where the fit starts [km, km/s]
    epoch: UTC text

    Raises InputError where SGP4 does not come near them.
    """
    (time,) = ccsds.utc_texts(epoch, np.array([at]))
    since = t - at
    start = _osculating(known)
    near = np.abs(since) < _FIRST_ARC
    osculating = _nearest(start, lambda x: _misses(np.append(x, 0.0), time, since[near], positions[near]))
    found = _nearest(np.append(osculating, 0.0), lambda x: _misses(x, time, since, positions))
    rms = 1e3 * math.sqrt(np.mean(np.sum(_misses(found, time, since, positions) ** 2, axis=1)))
    if not rms < 1e3 * _LOST:
        raise InputError(f"mean elements: expected an orbit that SGP4 can fly about {time}, got none")
    return SetFit(_satellite(found, time), rms)


def _osculating(state: np.ndarray) -> np.ndarray:
    """Return the first six parameters of a state (6,) [km, km/s]. Raises InputError for no ellipse."""
    a, e, i, argp, raan, nu = coe_from_cartesian(1e3 * state, EARTH_GM).tolist()
    if not 0.0 <= e < 1.0:
        raise InputError(f"mean elements: expected an eccentricity below 1, got {e:.3g}")
    motion = _MINUTE * math.sqrt(EARTH_GM / a**3)
    longitude = argp + float(mean_from_true_anomaly(nu, e))
    return np.array([motion, e * math.cos(argp), e * math.sin(argp), i, raan, longitude])


def _nearest(start: np.ndarray, misses: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the parameters of least squares."""
    return np.asarray(least_squares(lambda x: misses(x).ravel(), start, method="lm", x_scale="jac").x)


def _misses(parameters: np.ndarray, time: str, since: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Return the distances (n, 3) [km] of SGP4 from positions (n, 3) at times (n,) [s] from a UTC text on."""
    flying = _satellite(parameters, time)
    days = flying.jdsatepochF + since / DAY
    errors, flown, _ = flying.sgp4_array(np.full(len(since), flying.jdsatepoch), days)
    return np.where(errors[:, None] == 0, flown - positions, _LOST)


def _satellite(parameters: np.ndarray, epoch: str) -> Satrec:
    """Return the satellite of parameters.

    parameters: (7,) mean motion [rad/min], e cos w, e sin w, inclination, node, w + M [rad], B*
    epoch: UTC text
    """
    motion, x, y, inclination, node, longitude, bstar = parameters.tolist()
    perigee = math.atan2(y, x)
    angles = (angle % (2.0 * math.pi) for angle in (node, perigee, longitude - perigee))
    return satellite(epoch, [motion, math.hypot(x, y), inclination, *angles, bstar])
