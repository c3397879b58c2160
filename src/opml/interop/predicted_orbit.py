"""An orbit from a date on with a covariance, whatever it was predicted from: states, a table, an OEM."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

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
from opml.orbits.density_error import DensityErrors
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
class PredictedOrbit(ABC):
    """An object from a date on.

    date: UTC text at which it begins; days: how long it is; past: judged predictions of the object's past,
    morning, lead [days], left, what they were off by along the track [m]; basis: of its covariance, in words.
    """

    identity: ObjectId
    date: str
    days: float
    past: pd.DataFrame
    basis: str

    @property
    @abstractmethod
    def way(self) -> str:
        """Model that was used, in words."""

    @property
    @abstractmethod
    def reason(self) -> str:
        """Why that was used, in words."""

    @property
    def past_in_words(self) -> str:
        """Errors of SGP4 and of the improved set on past mornings, '' where that is unknown."""
        return ""

    def __repr__(self) -> str:
        """Return what was predicted, and how, in two lines."""
        return f"<{self.identity}, {self.days:g} days from {self.date} UTC\n {self.way}>"

    @property
    def remark(self) -> str:
        """Comment on it in a message."""
        return self.way

    @abstractmethod
    def _propagated(self, t: np.ndarray) -> np.ndarray:
        """Return GCRF states (n, 6) [m, m/s] at times (n,) within the prediction [s since the date]."""

    def states(self, t: np.ndarray) -> np.ndarray:
        """Return GCRF states (n, 6) [m, m/s] at times (n,) [s since the date].

        Raises InputError for times outside the prediction, and where SGP4 has the object decayed.
        """
        if not np.all((t >= 0.0) & (t <= DAY * self.days + _ROUNDED)):
            begin, end = self._texts(np.array([0.0, DAY * self.days]))
            raise InputError(f"predict: expected a time from {begin} to {end}, got another")
        return self._propagated(t)

    @abstractmethod
    def sigmas(self, t: np.ndarray) -> np.ndarray:
        """Return standard deviations (n, 3) in RSW [m] at times (n,) [s since the date]."""

    @abstractmethod
    def covariances(self, t: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Return covariances (n, 6, 6) in RSW [m, m/s] at times (n,) [s since the date]."""

    def density(self, t: np.ndarray, states: np.ndarray) -> DensityErrors | None:
        """Return the part of the covariances at times (n,) that other objects share, None where unknown."""
        return None

    def state(self, time: epochs.Time) -> np.ndarray:
        """Return the GCRF state (6,) [m, m/s] at a time (UTC). Raises InputError as `states` does."""
        return self.states(epochs.seconds_to(self.date, time))[0]

    def covariance(self, time: epochs.Time) -> np.ndarray:
        """Return the covariance (6, 6) in RSW [m, m/s] at a time (UTC); raises as `states` does."""
        t = epochs.seconds_to(self.date, time)
        return self.covariances(t, self.states(t))[0]

    @cached_property
    def t(self) -> np.ndarray:
        """Times (n,) of the ephemeris [s since the date]."""
        return read_only(STEP * np.arange(int((DAY * self.days + _ROUNDED) / STEP) + 1))

    def to_pandas(self) -> pd.DataFrame:
        """Return the ephemeris, a row a minute: utc, GCRF state [m, m/s], sigma_r, sigma_s, sigma_w [m]."""
        sigmas = dict(zip(("sigma_r", "sigma_s", "sigma_w"), self.sigmas(self.t).T, strict=True))
        states = pd.DataFrame(self.states(self.t), columns=STATE)
        states.insert(0, "utc", self._texts(self.t))
        return states.assign(**sigmas)

    def ephemeris(self) -> Ephemeris:
        """Return the ephemeris with covariances, times since the date."""
        states, last = self.states(self.t), len(self.t) - 1
        sparse, rare = (np.unique(np.r_[0:last:every, last]) for every in (_COVARIANCE_EVERY, _DENSITY_EVERY))
        covariances = self.covariances(self.t[sparse], states[sparse])
        known = np.isfinite(covariances).all(axis=(1, 2))
        return Ephemeris(
            self.identity.name,
            self.t,
            states,
            self.t[sparse][known],
            covariances[known],
            covariance_frame="RSW",
            remark=f"{self.remark}; {UNKNOWABLE}",
            degree=7,
            identity=self.identity,
            known=0.0,
            density=self.density(self.t[rare], states[rare]),
        )

    def to_oem(self, path: FilePath) -> None:
        """Write the ephemeris with covariances as an OEM."""
        oem.write(path, [self.ephemeris()], epoch=self.date)

    def expected(self) -> pd.DataFrame:
        """Return the table `expected_errors`, in RSW [m]."""
        leads = np.array([lead for lead in LEADS if lead <= self.days])
        sigmas = self.sigmas(DAY * leads)
        columns = {"lead": leads, "utc": self._texts(DAY * leads)}
        axes = {name: sigmas[:, k] for name, k in (("along_track", 1), ("radial", 0), ("cross_track", 2))}
        return pd.DataFrame({**columns, **axes, "sgp4_along_track": np.nan})

    def _texts(self, t: np.ndarray) -> list[str]:
        return ccsds.utc_texts(self.date, t)
