"""An object that is watched: its propagators, what is asked of its mornings, what was measured of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR, WGS84_A
from opml.catalog.fit.estimation_settings import Estimation
from opml.catalog.fit.first.first_orbit import TimedState
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator
from opml.element_sets.catalogue import modified_julian_day
from opml.element_sets.improved_history import ImprovedHistory
from opml.element_sets.weighting import DENSITY, LEARNED
from opml.interop.element_sets import histories, mean_elements
from opml.interop.element_sets.element_set import mean_height, semi_major_axis
from opml.interop.object_ids import UNKNOWN, ObjectId
from opml.learning.models import learners
from opml.learning.models.contract import ResolvedSettings
from opml.orbits.elements import in_rsw
from opml.orbits.manoeuvres import Manoeuvre
from opml.orbits.sheets import Station
from opml.tables import state_rows

SGP4 = "sgp4"  # name of the model that follows SGP4 along the track

Expected = Callable[[pd.DataFrame], np.ndarray]
"""How far a path is off along the track (n,) [m], by what another orbit says."""

_MARGIN = DAY
"""Tracks so long before the longest window are read [s]: an estimate of a morning is up to a day old."""

_MINUTE = 60.0

_HIGH = 420e3  # height of a perigee from which on fits to mean elements need less of the field [m]


@dataclass(frozen=True, eq=False)
class Sgp4:
    """The prediction of an object's public sets, and of the same sets improved.

    improved: the sets of all objects that are watched; None where nothing improves them
    """

    sets: pd.DataFrame  # table `element_sets` of the object
    epoch: str  # UTC text from which its times count
    improved: ImprovedHistory | None = None

    def is_above(self, least: float, *, now: float) -> bool:
        """Return whether the mean height of the newest set that is known [m] is not below the least.

        now: by when sets are known [s]
        """
        newest = histories.newest_before(self.sets, now)
        return newest is None or bool(mean_height(_MINUTE * self.sets["mean_motion"].iloc[newest]) >= least)

    def has_high_perigee(self, *, now: float) -> bool:
        """Return whether the perigee of the newest set that is known by a time [s] is as high."""
        newest = histories.newest_before(self.sets, now)
        if newest is None:
            return False
        motion, e = (self.sets[name].iloc[newest] for name in ("mean_motion", "eccentricity"))
        return bool(semi_major_axis(_MINUTE * motion) * (1.0 - e) >= WGS84_A + _HIGH)

    def menu(self, now: float) -> dict[str, Expected]:
        """Return by model how far a path would be off along the track, were the object where SGP4 has it.

        now: by when sets are known [s]

        NaN where no set was known, and where SGP4 fails.
        """
        models = {SGP4: partial(histories.predict, self.sets, epoch=self.epoch, known=now)}
        if self.improved is not None:
            number, morning = int(self.sets["number"].iloc[0]), modified_julian_day(self.epoch) + now / DAY
            for name in (DENSITY, LEARNED):
                satellite = self.improved.newest(name, number, morning)
                if satellite is not None:
                    models[name] = partial(mean_elements.states, satellite, epoch=self.epoch)
        return {name: partial(_expected, states) for name, states in models.items()}


def _expected(states: Callable[..., np.ndarray], path: pd.DataFrame) -> np.ndarray:
    """Return how far a path is off along the track (n,) [m] of what gives states at times `t`."""
    predicted = state_rows(path)
    return in_rsw(predicted - states(t=path["t_j"].to_numpy()), predicted)[:, 1]


@dataclass(frozen=True)
class ObjectPropagators:
    """How an object is propagated."""

    fits: Propagator  # under what was measured of the weather by the time of each fit
    predictions: Propagator  # under what was known of it by t_i
    flattened: Propagator  # the same under the Earth's flattening alone, for the spread
    weathers: Weathers  # expected, and as they may come
    orientation: pd.DataFrame  # table `earth_orientation`
    high: tuple[Propagator, Propagator] | None = None  # of fits and predictions to sets of high orbits


@dataclass(frozen=True)
class MorningPlan:
    """What is asked of every morning of an object."""

    models: Mapping[str, ResolvedSettings]  # resolved settings of learners that learn nothing, by name
    estimation: Estimation  # of the fits over the base window
    max_days: float  # length of an ephemeris
    step: float  # between its epochs [s]
    end: float  # of the run [s]
    epoch: str  # UTC text
    fits_above: float = 0.0  # height of mean elements below which none of these models is used [m]
    has_message: bool = True  # whether its ephemerides are written as messages

    @property
    def base(self) -> float:
        """The window [h] of the fits that ephemerides start from, and are compared with."""
        return self.estimation.window_hours

    @property
    def other_windows(self) -> list[float]:
        """Windows [h] of fits that models ask for beside these."""
        return [hours for hours in learners.arc_windows(self.models.values()) if hours != self.base]

    @property
    def reach(self) -> float:
        """How far back from a morning tracks are read [s]."""
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
    sgp4: Sgp4 | None = None  # the prediction of the public sets, where mean elements were taken

    def on(self, now: float) -> "Watched":
        """Return it as its height on a morning [s] asks: low down, fits lose to SGP4 and none is used."""
        if self.sgp4 is None:
            return self
        if not self.sgp4.is_above(self.plan.fits_above, now=now):
            return replace(self, plan=replace(self.plan, models={}))
        if self.model.high is None or not self.sgp4.has_high_perigee(now=now):
            return self
        fits, predictions = self.model.high
        return replace(self, model=replace(self.model, fits=fits, predictions=predictions))

    def known_by(self, now: float) -> list[Manoeuvre]:
        """Return the manoeuvres that are known by a time [s]."""
        return [one for one in self.manoeuvres if one.counts_from <= now]

    def aware_of(self, burns: Sequence[Manoeuvre]) -> "Watched":
        """Return it with burns that its tracks showed."""
        return replace(self, manoeuvres=sorted([*self.manoeuvres, *burns], key=lambda one: one.t))
