"""An object that is watched: its propagators, what is asked of its mornings, what was measured of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first.first_orbit import TimedState
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator
from opml.element_sets.station_passes import Place
from opml.ephemerides.fit_sizes import GIVEN
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.sheets import Station

_MARGIN = DAY
"""Tracks so long before the longest window are read [s]: an estimate of a morning is up to a day old."""


@dataclass(frozen=True)
class ObjectPropagators:
    """Propagators of an object."""

    fits: Propagator  # under what was measured of the weather by the time of each fit
    predictions: Propagator  # under what was known of it by t_i
    flattened: Propagator  # the same under the Earth's flattening alone, for the spread
    weathers: Weathers  # expected, and as they may come
    orientation: pd.DataFrame  # table `earth_orientation`


@dataclass(frozen=True)
class MorningPlan:
    """Settings of every morning of an object."""

    models: Mapping[str, ResolvedSettings]  # resolved settings of learners that learn nothing, by name
    estimation: Estimation  # of the fits over the base window
    max_days: float  # length of an ephemeris
    step: float  # between its epochs [s]
    end: float  # of the run [s]
    epoch: str  # UTC text
    light: float = GIVEN  # part of light's pressure on the body that errs
    has_message: bool = True  # whether its ephemerides are written as messages
    passes: Sequence[Place] = ()  # over which passes are written beside them

    @property
    def base(self) -> float:
        """The window [h] of the fits that ephemerides start from, and are compared with."""
        return self.estimation.window_hours

    @property
    def windows(self) -> list[float]:
        """Windows [h] of the fits that models ask for."""
        return learners.arc_windows(self.models.values())

    @property
    def other_windows(self) -> list[float]:
        """Windows [h] of fits that models ask for beside these."""
        return [hours for hours in self.windows if hours != self.base]

    @property
    def reach(self) -> float:
        """Time before a morning from which on tracks are read [s]."""
        return max([self.base, *self.other_windows]) * HOUR + _MARGIN


@dataclass(frozen=True)
class Watched:
    """An object that is watched."""

    model: ObjectPropagators
    plan: MorningPlan
    tracking: pd.DataFrame  # all that was measured, the table or one in its place
    stations: Sequence[Station]  # of the tracks
    manoeuvres: Sequence[Manoeuvre] = ()  # each counts from when it is known
    given: TimedState | None = None  # a state that the very first fits may start from
    identity: ObjectId = UNKNOWN  # what else than its name in the run tells the object

    def known_by(self, now: float) -> list[Manoeuvre]:
        """Return the manoeuvres that are known by a time [s]."""
        return [one for one in self.manoeuvres if one.counts_from <= now]

    def aware_of(self, burns: Sequence[Manoeuvre]) -> "Watched":
        """Return it with burns that its tracks showed."""
        return replace(self, manoeuvres=sorted([*self.manoeuvres, *burns], key=lambda one: one.t))
