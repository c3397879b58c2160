"""Forces under which the orbits inside public sets are sought: full ones, under the weather as it was known.

A publisher's forces are not known in detail; these agree with what theirs make of an orbit to some metres.
"""

import hashlib
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import numpy as np

from opml.base import epochs
from opml.base.constants import BODIES, DAY
from opml.dynamics.ensemble import Arcs, Departures, is_loaded, propagate
from opml.dynamics.forces import build, measured, with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.settings import FORCES, ForceModelSettings, Integrator
from opml.environment import known_weather
from opml.environment.known_weather import Issues

GRAVITY = "EGM2008"

DEGREE = 48
"""Degree of gravity. At 400 km a field of 36 moves an orbit by 25 m across the track in a week; one of 70
takes twice the time and differs by 5 m."""

HIGH = {1200e3: 24, 850e3: 36}
"""Degrees that serve from heights of the perigee on [m]; the highest ones first."""

ISSUE_HOURS = 24
AHEAD = 12.0  # longest arc after an issue [d]: a week from a date on, the age of the set and of the weather
SMOOTH = 8
"""Degree of gravity under which the effects of drag and light are differenced: within 0.2 % of those under
the whole field from 300 to 800 km, in a ninth of the time."""

STEPS = Integrator(position_tolerance_m=0.05, min_step_s=0.001, max_step_s=240.0)
"""Steps of orbits: half as long, they differ by 0.2 m outwards and across after eight days."""

_SMOOTH_STEPS = Integrator(position_tolerance_m=1.0, min_step_s=0.001, max_step_s=450.0)

ON_ALL_CORES = partial(propagate, threads=os.cpu_count() or 1)

_BEFORE = 9.0  # days before the first set that its span reaches


@dataclass(frozen=True)
class Forces:
    """A force model whose times count from `epoch` (UTC text), with daily outlooks of the weather.

    propagator: `ensemble.propagate`, or one like it; smooth: the model of `smoothed`, None: of this one
    """

    model: ForceModel
    epoch: str
    propagator: Callable[..., Arcs]
    steps: Integrator = STEPS
    smooth: ForceModel | None = None

    @cached_property
    def smoothed(self) -> "Forces":
        """Those with gravity of degree SMOOTH; one model, as arcs under the same one share blocks."""
        return replace(self, model=self.smooth or self.model.truncated(SMOOTH), steps=_SMOOTH_STEPS)

    def above(self, height: float) -> "Forces":
        """Return those that act on orbits above a height [m]: less of the field is felt farther up."""
        return next((part for least, part in self._parts.items() if height >= least), self)

    @cached_property
    def _parts(self) -> dict[float, "Forces"]:
        smooth = self.smoothed.model
        return {
            least: replace(self, model=self.model.truncated(degree), smooth=smooth)
            for least, degree in HIGH.items()
        }

    def digest(self, known: float, until: float) -> bytes:
        """Return a digest of what acts on arcs under the weather of a time, until another [s]."""
        model, digest = self.model, hashlib.sha256(repr((self.epoch, self.steps, self.model.degree)).encode())
        newest = int(model.newest_outlook(np.array(known)))
        nodes = int((until - model.first) / model.step) + 4
        measured = model.activity[0, : model.known[newest] if newest >= 0 else nodes]
        turning, pulling = (table[:nodes] for table in (model.orientation, model.bodies))
        for table in (measured, model.outlooks[: newest + 1], turning, pulling, model.weights):
            digest.update(np.ascontiguousarray(table).tobytes())
        return digest.digest()

    def propagate(self, epochs: np.ndarray, departures: Departures) -> Arcs:
        """Propagate arcs as `ensemble.propagate`."""
        return self.propagator(self.model, epochs, departures, integrator=self.steps)

    def run(self, calls: Sequence[Callable[[], Arcs]]) -> list[Arcs]:
        """Return what calls that propagate return, side by side where no other callers share their blocks.

        The first arcs of a process load the kernels alone.
        """
        if self.propagator is not ON_ALL_CORES or not is_loaded():
            return [call() for call in calls]
        with ThreadPoolExecutor(len(calls)) as threads:
            return [each.result() for each in [threads.submit(call) for call in calls]]

    def time(self, date: str) -> float:
        """Return the time of UTC text [s since the epoch]."""
        return epochs.seconds_between(self.epoch, date)


def read(
    weather: str | Path,
    *,
    first: float,
    last: float,
    degree: int = DEGREE,
    propagator: Callable[..., Arcs] = ON_ALL_CORES,
) -> Forces:
    """Return the forces for sets with epochs from `first` to `last` (modified Julian days, UTC).

    weather: OBSERVED, the packaged weather, or a CSSI file; what was measured after an issue does not count
    in an arc that begins under it

    Raises InputError where the weather is unreadable, or begins too late.
    """
    epoch = f"{epochs.calendar(np.floor(first) - _BEFORE)}T00:00:00"
    days = last - np.floor(first) + _BEFORE + AHEAD
    environment = measured(weather, epoch, DAY * days, gravity=GRAVITY, degree=degree)
    settings = ForceModelSettings.read(
        {"degree": degree, "order": degree, "third_bodies": [*BODIES], "forces": [*FORCES]}, "forces"
    )
    issues = Issues(source=weather, epoch=epoch, issue_hours=ISSUE_HOURS, max_days=AHEAD)
    outlooks = known_weather.outlooks(issues, environment.solar_activity["t"].to_numpy())
    model = with_outlooks(build(environment, settings), outlooks)
    return Forces(model, epoch, propagator)
