"""A force model as the kernels read it, from the environment's tables."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.constants import BODIES, SPEED_OF_LIGHT
from opml.base.epochs import days_of_year
from opml.dynamics import solid_tides as solid_earth
from opml.dynamics.frames import ORIENTATION, spin
from opml.dynamics.kernels import dtm2000
from opml.dynamics.kernels.added_forces import FORCES, OFF
from opml.dynamics.kernels.gravity import weights
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.kernels.tides import DEGREE, ORDER, no_tides, tides
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings
from opml.environment import celestial_bodies, earth_orientation, gravity_field, known_weather, nodes
from opml.environment.weather import ACTIVITY


def tabulated(
    epoch: str, t: np.ndarray, activity: pd.DataFrame, *, gravity: str | Path, degree: int
) -> Environment:
    """Tabulate an environment at times `t` (n,) [s since `epoch`, UTC text], as `environment.nodes` has them.

    activity: table `solar_activity`; gravity: name or file of the field, up to a degree

    Raises InputError where a source cannot be read or does not reach.
    """
    field = gravity_field.read_icgem(gravity_field.resolve(gravity)).truncate(degree, degree)
    return Environment(
        epoch=epoch,
        earth_orientation=earth_orientation.tabulate(epoch, t),
        ephemerides=celestial_bodies.tabulate(epoch, t),
        solar_activity=activity,
        gravity_field=gravity_field.table(field, epoch),
        gm=field.gm,
        radius=field.radius,
        tide_system=field.tide_system,
    )


def measured(
    weather: str | Path, epoch: str, duration: float, *, gravity: str | Path, degree: int
) -> Environment:
    """Tabulate an environment for a duration [s] under the weather as measured, up to its last measurement.

    weather: OBSERVED, the packaged weather, or a CSSI file

    Raises InputError where a source cannot be read, or begins too late.
    """
    t = nodes(epoch, duration)
    activity = known_weather.measured_activity(weather, epoch, t)
    return tabulated(epoch, t, activity, gravity=gravity, degree=degree)


def build(environment: Environment, settings: ForceModelSettings) -> ForceModel:
    """Make a force model from an environment.

    environment: the tables of Earth orientation, third bodies and solar activity have the same uniform nodes,
    that of the gravity field is fully normalised

    Raises InputError where the field is of a tide system to which no tides can be added.
    """
    earth_orientation = environment.earth_orientation
    t = earth_orientation["t"].to_numpy()
    activity = np.ascontiguousarray(environment.solar_activity[ACTIVITY].to_numpy(float))
    pulling = settings.third_bodies
    names = ["sun", *(name for name in BODIES if name in pulling and name != "sun")]
    columns = [f"{name}_{axis}" for name in names for axis in "xyz"]
    midnight, days = days_of_year(environment.epoch, t[-1])
    coefficients = dtm2000.coefficients()
    c, s = _coefficients(environment.gravity_field, settings.degree, settings.order)
    if "solid_tides" in settings.forces:
        c, s = _padded(c), _padded(s)
    factors, earth_tides = weights(c, s), no_tides()
    if "solid_tides" in settings.forces:
        earth_tides = tides(solid_earth.nodes(environment), factors, len(c) - 1)
    added, columns_of_added = _added(environment, settings.forces)
    return ForceModel(
        first=float(t[0]),
        step=float(t[1] - t[0]),
        orientation=np.ascontiguousarray(earth_orientation[ORIENTATION].to_numpy(float)),
        spin=np.ascontiguousarray(spin(earth_orientation)),
        added=added,
        columns_of_added=columns_of_added,
        bodies=np.ascontiguousarray(environment.ephemerides[columns].to_numpy(float)),
        gms=np.array([environment.gms[name] if name in pulling else 0.0 for name in names]),
        activity=activity[None],
        flown=np.ones(1, np.bool_),
        midnight=float(midnight),
        seasons=np.ascontiguousarray(dtm2000.seasons(coefficients, days)),
        thermosphere=coefficients,
        weights=factors,
        tides=earth_tides,
        columns=c.shape[1] + 1,
        degree=len(c),
        gm=float(environment.gm),
        radius=float(environment.radius),
        issued=np.empty(0),
        known=np.empty(0, int),
        outlooks=np.empty((0, 0, activity.shape[1])),
    )


def _padded(coefficients: np.ndarray) -> np.ndarray:
    """Return coefficients up to the highest degree and order of a tide at least, 0 where there were none."""
    missing = np.maximum(np.array([DEGREE + 1, ORDER + 1]) - coefficients.shape, 0)
    return np.pad(coefficients, [(0, count) for count in missing])


def _added(environment: Environment, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the first column of each added force, OFF where it is not selected, and the columns of all."""
    nothing = np.empty((len(environment.ephemerides), 0))
    needing = {*TABULATED} & {*names}
    parts = [TABULATED[name](environment) if name in needing else nothing for name in FORCES]
    first = np.cumsum([0, *(part.shape[1] for part in parts[:-1])])
    return np.where([name in names for name in FORCES], first, OFF), np.hstack(parts)


def _precession(environment: Environment) -> np.ndarray:
    """Return the vector (nodes, 3) by which velocities turn about the moving Earth [rad/s].

    Source: IERS Conventions 2010, eq. 10.12, the third term; it is twice the geodesic precession.
    """
    t = environment.ephemerides["t"].to_numpy()
    earth = -environment.ephemerides[["sun_x", "sun_y", "sun_z"]].to_numpy()
    velocity = np.gradient(earth, t, axis=0, edge_order=2)
    distance = np.linalg.norm(earth, axis=1, keepdims=True)
    turning: np.ndarray = np.cross(earth, velocity) / distance**3
    return 3.0 * environment.gms["sun"] / SPEED_OF_LIGHT**2 * turning


TABULATED = {"relativity": _precession}
"""Time-dependent columns of added forces, (nodes, columns) of an environment, by name."""


def with_outlooks(model: ForceModel, table: pd.DataFrame) -> ForceModel:
    """Return a model whose arcs are propagated under what was known when they start.

    table: `outlooks`, at the model's nodes

    Up to an issue the activity is that of the model. Beyond the forecast it is not finite, so that no arc
    is propagated there unnoticed.
    """
    issued, outlook = np.unique(table["issued"].to_numpy(), return_inverse=True)
    node = np.round((table["t"].to_numpy() - model.first) / model.step).astype(int)
    known = np.full(len(issued), model.activity.shape[1])
    np.minimum.at(known, outlook, node)
    after = node - known[outlook]
    expected = np.full((len(issued), after.max(initial=-1) + 1, len(ACTIVITY)), np.nan)
    expected[outlook, after] = table[ACTIVITY].to_numpy(float)
    return model._replace(issued=issued, known=known, outlooks=expected)


def joined(models: Sequence[ForceModel]) -> ForceModel:
    """Return the first of models that differ in their outlooks alone, with those of all behind its own.

    Those behind its own are no newest ones: an arc is propagated under one where its departure names it.
    """
    width = max(model.outlooks.shape[1] for model in models)
    rows = [
        np.pad(model.outlooks, [(0, 0), (0, width - model.outlooks.shape[1]), (0, 0)], constant_values=np.nan)
        for model in models
    ]
    known = np.concatenate([model.known for model in models])
    return models[0]._replace(known=known, outlooks=np.concatenate(rows))


def _coefficients(gravity_field: pd.DataFrame, degree: int, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Return cosine and sine coefficients (degree + 1, order + 1) of a field, 0 where the table has none."""
    c, s = np.zeros((degree + 1, order + 1)), np.zeros((degree + 1, order + 1))
    used = gravity_field[(gravity_field["n"] <= degree) & (gravity_field["m"] <= order)]
    c[used["n"], used["m"]] = used["c"]
    s[used["n"], used["m"]] = used["s"]
    return c, s
