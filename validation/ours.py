"""Our side: the environment's tables fed with what Orekit reads, and the kernels' terms at single states."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from opml.base.constants import BODIES, GM
from opml.dynamics import forces, run_environment
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.kernels import surroundings
from opml.dynamics.kernels.acceleration import SCRATCH_ROWS, density
from opml.dynamics.kernels.drag import drag
from opml.dynamics.kernels.gravity import gravity
from opml.dynamics.kernels.lanes import entry, load, rows, splat, sqrt, store
from opml.dynamics.kernels.radiation_pressure import illumination, radiation_pressure
from opml.dynamics.kernels.relativity import de_sitter, lense_thirring, schwarzschild
from opml.dynamics.kernels.surroundings import AXIS, SPIN, SUN_ITRF, ForceModel, look_up
from opml.dynamics.kernels.third_body import third_bodies
from opml.dynamics.settings import ForceModelSettings, Integrator
from opml.environment import celestial_bodies, earth_orientation, gravity_field
from opml.orbits.sheets import Rso

PRECISE_TERMS = ("solid_tides", "schwarzschild", "lense_thirring", "de_sitter")
"""Terms that the settings' force models leave out."""


@dataclass(frozen=True)
class Environment:
    """The environment's tables, and the constants that go with them."""

    epoch: str
    tables: Mapping[str, pd.DataFrame]
    gm: float
    radius: float
    gms: Mapping[str, float]
    tide_system: str

    def model(self, settings: Mapping[str, Any]) -> ForceModel:
        """The force model of degree, order, third_bodies, and tides and relativity where on."""
        environment = run_environment.Environment(
            self.epoch,
            **self.tables,
            gm=self.gm,
            radius=self.radius,
            gms=self.gms,
            tide_system=self.tide_system,
        )
        return forces.build(environment, ForceModelSettings(**settings))

    def with_de440(self) -> "Environment":
        """Return these settings' environment, but with the third bodies of DE440, as in the product."""
        t = self.tables["ephemerides"]["t"].to_numpy()
        table = celestial_bodies.tabulate(self.epoch, t)
        return replace(self, tables={**self.tables, "ephemerides": table}, gms=GM)


def from_orekit(orekit, data, *, epoch: str, t: np.ndarray, degree: int) -> Environment:
    """Return the environment at nodes t [s] from the files that Orekit reads.

    Earth orientation and gravity field are read by opml itself; the third bodies and the solar activity are
    Orekit's, taken at the nodes, so that both sides have one kernel and one table of activity.
    """
    field = gravity_field.read_icgem(data.path("gravity field")).truncate(degree, degree)
    bulletin = data.path("Earth orientation")
    bodies = {"t": t}
    for name in BODIES:
        positions = np.array([orekit.body_position(name, time) for time in t])
        bodies |= {f"{name}_{axis}": positions[:, k] for k, axis in enumerate("xyz")}
    return Environment(
        epoch=epoch,
        tables={
            "earth_orientation": earth_orientation.tabulate(epoch, t, bulletin=bulletin),
            "ephemerides": pd.DataFrame(bodies),
            "solar_activity": pd.DataFrame([{"t": time, **orekit.activity_at(time)} for time in t]),
            "gravity_field": gravity_field.table(field, epoch),
        },
        gm=field.gm,
        radius=field.radius,
        gms={name: orekit.bodies[name].getGM() for name in BODIES},
        tide_system=field.tide_system,
    )


def fly(
    model: ForceModel, rsos: Sequence[Rso], starts: np.ndarray, t: np.ndarray, integrator: Integrator
) -> np.ndarray:
    """Return GCRF states (rsos, n, 6) at ascending times t [s], from `starts` (rsos, 6) at the epoch."""
    count = len(rsos)
    arcs = propagate(
        model,
        np.append(0.0, t),
        Departures(
            starts,
            first=np.zeros(count, int),
            last=np.full(count, len(t)),
            ballistic=[rso.cd * rso.area_to_mass for rso in rsos],
            reflection=[rso.cr * rso.area_to_mass for rso in rsos],
        ),
        integrator=integrator,
    )
    return np.array([arcs.path(k) for k in range(count)])


def terms(model: ForceModel, t: float, state: np.ndarray, rso: Rso) -> dict[str, Any]:
    """Return each force's acceleration [m/s2] in GCRF, and what it is made of, at a GCRF state (6,).

    Keys: rotation (3, 3), density [kg/m3], lit, drag (3,), srp (3,) and bodies (bodies of the model, 3).
    """
    values, factors = surroundings.allocate(model)
    scratch, out = rows(SCRATCH_ROWS), rows(8 + 3 * len(model.gms))
    ballistic, reflection = rso.cd * rso.area_to_mass, rso.cr * rso.area_to_mass
    _terms(model, t, _in_lanes(state), ballistic, reflection, values, factors, scratch, out)
    found = out[:, 0]
    return {
        "rotation": values[:9].reshape(3, 3),
        "density": found[0],
        "lit": found[1],
        "drag": found[2:5],
        "srp": found[5:8],
        "bodies": found[8:].reshape(-1, 3),
    }


def precise_terms(model: ForceModel, t: float, state: np.ndarray) -> dict[str, np.ndarray]:
    """Return the accelerations (3,) [m/s2] in GCRF of PRECISE_TERMS, at a GCRF state (6,)."""
    values, factors = surroundings.allocate(model)
    out = rows(3 * len(PRECISE_TERMS))
    _precise_terms(tides_alone(model), t, _in_lanes(state), values, factors, out)
    found = dict(zip(PRECISE_TERMS, out[:, 0].reshape(-1, 3), strict=True))
    return found | {"solid_tides": values[:9].reshape(3, 3).T @ found["solid_tides"]}


def tides_alone(model: ForceModel) -> ForceModel:
    """Return a model whose field beyond the central term is that of the tides."""
    still = model.weights.copy()
    still[:, 1:] = 0.0
    return model._replace(weights=still.copy(), tides=model.tides._replace(still=still))


def gravity_beyond_central(model: ForceModel, position: np.ndarray) -> np.ndarray:
    """Return the field's acceleration (3,) [m/s2] but its central term, at an ITRF position (3,) [m]."""
    out = rows(3)
    _gravity(model, _in_lanes(position), out)
    return out[:, 0]


def _in_lanes(values):
    filled = rows(len(values))
    filled[:] = np.asarray(values, float)[:, None]
    return filled


@entry
def _gravity(model, place, out):
    x, y, z = load(place, 0), load(place, 1), load(place, 2)
    r2 = x * x + y * y + z * z
    acceleration = gravity(
        x, y, z, 1.0 / sqrt(r2), model.weights, model.columns, model.degree, model.gm, model.radius
    )
    _store_vector(out, 0, acceleration)


@entry
def _precise_terms(model, t, state, values, factors, out):
    look_up(t, model, values, factors)
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    vx, vy, vz = load(state, 3), load(state, 4), load(state, 5)
    inverse_r = 1.0 / sqrt(x * x + y * y + z * z)
    px = values[0] * x + values[1] * y + values[2] * z
    py = values[3] * x + values[4] * y + values[5] * z
    pz = values[6] * x + values[7] * y + values[8] * z
    tide = gravity(px, py, pz, inverse_r, model.weights, model.columns, model.degree, model.gm, model.radius)
    _store_vector(out, 0, tide)
    _store_vector(out, 3, schwarzschild(x, y, z, vx, vy, vz, inverse_r, model.gm))
    axis = values[AXIS : AXIS + 3]
    _store_vector(out, 6, lense_thirring(x, y, z, vx, vy, vz, inverse_r, model.gm, axis))
    _store_vector(out, 9, de_sitter(vx, vy, vz, values[surroundings.BODIES + model.bodies.shape[1] :]))


@entry
def _terms(model, t, state, ballistic, reflection, values, factors, scratch, out):
    look_up(t, model, values, factors)
    x, y, z = load(state, 0), load(state, 1), load(state, 2)
    vx, vy, vz = load(state, 3), load(state, 4), load(state, 5)
    r2 = x * x + y * y + z * z
    px = values[0] * x + values[1] * y + values[2] * z
    py = values[3] * x + values[4] * y + values[5] * z
    pz = values[6] * x + values[7] * y + values[8] * z
    _, rho = density(px, py, pz, 1.0 / sqrt(r2), splat(0.0), model, values, factors, scratch)
    lit = illumination(px, py, pz, r2, values[SUN_ITRF : SUN_ITRF + 3], scratch)
    store(out, 0, rho)
    store(out, 1, lit)
    turning = (values[SPIN], values[SPIN + 1], values[SPIN + 2])
    _store_vector(out, 2, drag(x, y, z, vx, vy, vz, turning, rho, splat(ballistic)))
    bodies = values[surroundings.BODIES :]
    _store_vector(out, 5, radiation_pressure(x, y, z, bodies[:3], lit, splat(reflection)))
    for k in range(model.gms.shape[0]):
        _store_vector(out, 8 + 3 * k, third_bodies(x, y, z, bodies[3 * k :], model.gms[k : k + 1], 1))


@entry
def _store_vector(out, row, vector):
    store(out, row, vector[0])
    store(out, row + 1, vector[1])
    store(out, row + 2, vector[2])
