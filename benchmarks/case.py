"""What is flown: arcs of the paper's RSO, spread over a week as the workflow's estimates are."""

from dataclasses import dataclass, replace
from functools import cache
from typing import Self

import numpy as np

from opml.base.constants import DAY
from opml.base.epochs import seconds_between
from opml.base.seeds import derive
from opml.catalog.simulate.truth import initial_state
from opml.dynamics import forces
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.environment import celestial_bodies, earth_orientation, gravity_field, nodes, solar_activity
from validation.case import Case

DAYS = 7.0
"""Length of an arc, and of the span in which arcs begin."""

_BEFORE = 0.01
"""How long before midnight [s] a step ends: what the jump does in this time is nothing."""

_SPREAD = np.repeat([100.0, 0.1], 3)
"""Standard deviations [m, m/s] of the starts about the RSO's orbit, as of estimates from a few tracks."""


def spread(total: int, count: int) -> np.ndarray:
    """Return the indices of `count` of `total` things, evenly spread."""
    return np.linspace(0, total - 1, count).round().astype(int)


@dataclass(frozen=True)
class Arcs:
    """Arcs that begin at t (n,) [s since the epoch] with states (n, 6) GCRF and last `duration` [s].

    ballistic: Cd A/m, reflection: Cr A/m [m2/kg], the same for all.
    """

    t: np.ndarray
    states: np.ndarray
    duration: float
    ballistic: float
    reflection: float

    def __len__(self) -> int:
        return len(self.t)

    @property
    def arc_days(self) -> float:
        """Days flown by all arcs together."""
        return len(self) * self.duration / DAY

    def stops(self, begin: float) -> np.ndarray:
        """Return the times [s] to stop at on an arc from its beginning: about midnights (UTC), and its end.

        Models of the atmosphere jump at midnight, so a step ends just before it: it sees the old day only.
        """
        first = seconds_between(paper().epoch, f"{paper().epoch[:10]}T00:00:00")
        midnights = first + DAY * np.arange(3 * DAYS)
        stops, end = np.ravel([midnights - _BEFORE, midnights], order="F"), begin + self.duration
        return np.append(stops[(stops > begin) & (stops < end)], end)

    def sample(self, count: int) -> Self:
        """Return `count` of the arcs, evenly spread."""
        picked = spread(len(self), count)
        return replace(self, t=self.t[picked], states=self.states[picked])

    def lasting(self, duration: float) -> Self:
        """Return the same arcs of another length [s]."""
        return replace(self, duration=duration)

    def without_drag(self) -> Self:
        """Return the same arcs in a vacuum."""
        return replace(self, ballistic=0.0)

    def without_pressure(self) -> Self:
        """Return the same arcs without radiation pressure."""
        return replace(self, reflection=0.0)


@cache
def paper() -> Case:
    """Return the paper's case, from the settings."""
    return Case.read()


@cache
def environment(days: float) -> dict:
    """Return the environment's tables over `days` from the epoch, without the gravity field."""
    epoch, settings = paper().epoch, paper().values["environment"]
    t = nodes(epoch, days * DAY)
    return {
        "earth_orientation": earth_orientation.tabulate(epoch, t),
        "ephemerides": celestial_bodies.tabulate(epoch, t),
        "solar_activity": solar_activity.tabulate(
            settings["solar_activity"], epoch, t, settings["percentile"]
        ),
    }


@cache
def force_model(name: str, *, days: float = 2 * DAYS, field: str = "EGM2008") -> ForceModel:
    """Return the paper's force model 'truth' or 'assumed' over `days`; field: its name or path."""
    read, settings = gravity_field.read_icgem(gravity_field.resolve(field)), paper().force_models[name]
    table = gravity_field.table(read.truncate(settings["degree"], settings["order"]), paper().epoch)
    surroundings = Environment(
        paper().epoch, **environment(days), gravity_field=table, gm=read.gm, radius=read.radius
    )
    return forces.build(surroundings, ForceModelSettings(**settings))


def arcs(count: int) -> Arcs:
    """Return `count` arcs of the paper's RSO, beginning one after the other in the first week."""
    rso, model = paper().rsos["iss"], force_model("assumed")
    t = np.arange(count) * (DAYS * DAY / count)
    ballistic, reflection = rso.cd * rso.area_to_mass, rso.cr * rso.area_to_mass
    start = initial_state(rso, model.gm)
    flown = propagate(
        model,
        t,
        Departures(start[None], first=[0], last=[count - 1], ballistic=[ballistic], reflection=[reflection]),
        integrator=paper().integrator,
    ).states
    noise = derive(paper().values["seed"]["noise"], "benchmarks", "starts").normal(size=(count, 6))
    return Arcs(t, np.vstack([start, flown]) + noise * _SPREAD, DAYS * DAY, ballistic, reflection)


def fly(
    model: ForceModel, arcs: Arcs, *, integrator: Integrator | None = None, threads: int = 1
) -> np.ndarray:
    """Fly the arcs by opml's ensemble; return the states (n, 6) at their ends.

    As the workflow does it: every arc also stops where others begin or end.
    """
    ends = arcs.t + arcs.duration
    epochs = np.unique(np.round(np.concatenate([arcs.t, ends]), 6))
    flown = propagate(
        model,
        epochs,
        Departures(
            arcs.states,
            first=np.searchsorted(epochs, np.round(arcs.t, 6)),
            last=np.searchsorted(epochs, np.round(ends, 6)),
            ballistic=np.full(len(arcs), arcs.ballistic),
            reflection=np.full(len(arcs), arcs.reflection),
        ),
        integrator=integrator or paper().integrator,
        threads=threads,
    )
    return flown.states[flown.start[1:] - 1]
