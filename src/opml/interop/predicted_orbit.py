"""An orbit from a date on with a covariance, whatever it was predicted from: states, a table, an OEM."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from opml.base import epochs
from opml.base.arrays import read_only
from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.interop import ccsds, oem
from opml.interop.ephemeris import Ephemeris
from opml.interop.object_ids import ObjectId
from opml.orbits.rsw_covariance import ErrorModel
from opml.tables import STATE

LEADS = (0, 1, 3, 5, 7)  # days from the date at which expected errors are stated
UNKNOWABLE = "future manoeuvres are not modelled"  # what no covariance knows
STEP = 60.0  # time between the states of an ephemeris [s]
_COVARIANCE_EVERY = 10  # states
_ROUNDED = 1e-6  # by what a number of days may miss a minute [s]
_DENSITY_EVERY = 180  # states: what density does grows slowly


LEAST_DAYS = 0.01  # length of a prediction, of states enough to interpolate


def check_days(days: float) -> None:
    """Raise InputError for a length of a prediction that is too short, or longer than errors are known."""
    if not LEAST_DAYS <= days <= LEADS[-1]:
        raise InputError(
            f"predict: expected at least {LEAST_DAYS:g} and at most {LEADS[-1]} days, got {days:g}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class PredictedOrbit:
    """An object from a date on.

    ephemeris: its states and covariances, times since the date; date: UTC text at which it begins; days: how
    long it is; past: judged predictions of the object's past, morning, lead [days], left, what they were off
    by along the track [m]; basis: of its covariance, way, reason: model that was used, and why, in words;
    past_in_words: errors of SGP4 and of such predictions before, '' where these are unknown.
    """

    ephemeris: Ephemeris
    date: str
    days: float
    past: pd.DataFrame
    basis: str
    way: str
    reason: str
    past_in_words: str = field(default="", kw_only=True)

    def __repr__(self) -> str:
        """Return what was predicted, and how, in two lines."""
        return f"<{self.identity}, {self.days:g} days from {self.date} UTC\n {self.way}>"

    @property
    def identity(self) -> ObjectId:
        """The object."""
        return self.ephemeris.identity

    @property
    def t(self) -> np.ndarray:
        """Times (n,) of the ephemeris [s since the date]."""
        return self.ephemeris.t

    def states(self, t: np.ndarray) -> np.ndarray:
        """Return GCRF states (n, 6) [m, m/s] at times (n,) [s since the date], as `Ephemeris.at`.

        Raises InputError for times outside the prediction.
        """
        if not np.all((t >= 0.0) & (t <= DAY * self.days + _ROUNDED)):
            begin, end = ccsds.utc_texts(self.date, np.array([0.0, DAY * self.days]))
            raise InputError(f"predict: expected a time from {begin} to {end}, got another")
        return self.ephemeris.at(t)

    def sigmas(self, t: np.ndarray) -> np.ndarray:
        """Return standard deviations (n, 3) in RSW [m] at times (n,) [s since the date], NaN if unknown."""
        covariances = self.ephemeris.covariances_at(t)
        return np.sqrt(np.diagonal(covariances, axis1=1, axis2=2)[:, :3])

    def state(self, time: epochs.Time) -> np.ndarray:
        """Return the GCRF state (6,) [m, m/s] at a time (UTC). Raises InputError as `states` does."""
        return self.states(epochs.seconds_to(self.date, time))[0]

    def covariance(self, time: epochs.Time) -> np.ndarray:
        """Return the covariance (6, 6) in RSW [m, m/s] at a time (UTC), linear between those each 10 min."""
        return self.ephemeris.covariances_at(epochs.seconds_to(self.date, time))[0]

    def to_pandas(self) -> pd.DataFrame:
        """Return the ephemeris, a row a minute: utc, GCRF state [m, m/s], sigma_r, sigma_s, sigma_w [m]."""
        sigmas = dict(zip(("sigma_r", "sigma_s", "sigma_w"), self.sigmas(self.t).T, strict=True))
        states = pd.DataFrame(self.ephemeris.states, columns=STATE)
        states.insert(0, "utc", ccsds.utc_texts(self.date, self.t))
        return states.assign(**sigmas)

    def to_oem(self, path: FilePath) -> None:
        """Write the ephemeris with covariances as an OEM."""
        oem.write(path, [self.ephemeris], epoch=self.date)

    def expected(self) -> pd.DataFrame:
        """Return the table `expected_errors`, in RSW [m]."""
        leads = np.array([lead for lead in LEADS if lead <= self.days])
        sigmas = self.sigmas(DAY * leads)
        columns = {"lead": leads, "utc": ccsds.utc_texts(self.date, DAY * leads)}
        axes = {name: sigmas[:, k] for name, k in (("along_track", 1), ("radial", 0), ("cross_track", 2))}
        return pd.DataFrame({**columns, **axes, "sgp4_along_track": np.nan})


def sampled(
    identity: ObjectId,
    days: float,
    states_at: Callable[[np.ndarray], np.ndarray],
    errors: ErrorModel,
    *,
    remark: str,
) -> Ephemeris:
    """Return the ephemeris of an orbit with covariances, a state a minute, times since its date.

    states_at: returns GCRF states (n, 6) [m, m/s] at times (n,)
    """
    t = read_only(STEP * np.arange(int((DAY * days + _ROUNDED) / STEP) + 1))
    states, last = states_at(t), len(t) - 1
    sparse, rare = (np.unique(np.r_[0:last:every, last]) for every in (_COVARIANCE_EVERY, _DENSITY_EVERY))
    covariances = errors.covariances(t[sparse], states[sparse])
    known = np.isfinite(covariances).all(axis=(1, 2))
    return Ephemeris(
        identity.name,
        t,
        states,
        t[sparse][known],
        covariances[known],
        covariance_frame="RSW",
        remark=f"{remark}; {UNKNOWABLE}",
        degree=7,
        identity=identity,
        known=0.0,
        density=errors.density(t[rare], states[rare]),
    )
