"""A force model as the kernels read it, from the environment's tables."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from opml.base.constants import BODIES, GM
from opml.base.epochs import days_of_year
from opml.base.thermosphere_grid import ALTITUDES, DENSITIES, LATITUDES, LOCAL_TIMES
from opml.dynamics.frames import ORIENTATION, spin
from opml.dynamics.kernels import dtm2000
from opml.dynamics.kernels.gravity import weights
from opml.dynamics.kernels.surroundings import ForceModel
from opml.environment.weather import ACTIVITY

_EMPTY = np.empty((0, len(LOCAL_TIMES), len(LATITUDES), len(ALTITUDES)), np.float32)


def build(
    earth_orientation: pd.DataFrame,
    ephemerides: pd.DataFrame,
    solar_activity: pd.DataFrame,
    gravity_field: pd.DataFrame,
    *,
    epoch: str,
    degree: int,
    order: int,
    bodies: Sequence[str],
    gm: float,
    radius: float,
    gms: Mapping[str, float] = GM,
    thermosphere: pd.DataFrame | None = None,
    outlooks: pd.DataFrame | None = None,
) -> ForceModel:
    """Make a force model from the environment's tables.

    earth_orientation, ephemerides, solar_activity: DataFrames at the same uniform nodes;
    gravity_field: DataFrame n, m, c, s (fully normalised); epoch: UTC text; degree, order: of the
    field used; bodies: names of the third bodies that pull; gm [m3/s2], radius [m]: of the field;
    gms: of the bodies [m3/s2]; thermosphere: densities at the same nodes, DTM2000's where there are none;
    outlooks: the table, where arcs fly under what was known when they start.
    """
    t = earth_orientation["t"].to_numpy()
    activity = np.ascontiguousarray(solar_activity[ACTIVITY].to_numpy(float))
    names = ["sun", *(name for name in BODIES if name in bodies and name != "sun")]
    columns = [f"{name}_{axis}" for name in names for axis in "xyz"]
    midnight, days = days_of_year(epoch, t[-1])
    coefficients = dtm2000.coefficients()
    model = ForceModel(
        first=float(t[0]),
        step=float(t[1] - t[0]),
        orientation=np.ascontiguousarray(earth_orientation[ORIENTATION].to_numpy(float)),
        spin=np.ascontiguousarray(spin(earth_orientation)),
        bodies=np.ascontiguousarray(ephemerides[columns].to_numpy(float)),
        gms=np.array([gms[name] if name in bodies else 0.0 for name in names]),
        activity=activity,
        midnight=float(midnight),
        seasons=np.ascontiguousarray(dtm2000.seasons(coefficients, days)),
        thermosphere=coefficients,
        tabulated=_EMPTY if thermosphere is None else logarithms(thermosphere),
        weights=weights(*_coefficients(gravity_field, degree, order)),
        columns=order + 2,
        degree=degree + 1,
        gm=float(gm),
        radius=float(radius),
        issued=np.empty(0),
        outlooks=np.empty((0, *activity.shape)),
    )
    return model if outlooks is None else with_outlooks(model, outlooks)


def logarithms(thermosphere: pd.DataFrame) -> np.ndarray:
    """A tabulated thermosphere as the kernels read it, in single precision: 2e-6 of a density."""
    shape = (-1, len(LOCAL_TIMES), len(LATITUDES), len(ALTITUDES))
    logarithms = np.log(thermosphere[list(DENSITIES)].to_numpy()).astype(np.float32)
    return np.ascontiguousarray(logarithms).reshape(shape)


def with_outlooks(model: ForceModel, table: pd.DataFrame) -> ForceModel:
    """The model whose arcs fly under what was known when they start, by a table `outlooks` of its nodes.

    Up to an issue the activity is the model's own. Beyond the forecast it is not finite, so that no arc flies
    there unnoticed.
    """
    t = model.first + model.step * np.arange(len(model.activity))
    issued, outlook = np.unique(table["issued"].to_numpy(), return_inverse=True)
    expected = np.where((t <= issued[:, None])[..., None], model.activity, np.nan)
    node = np.round((table["t"].to_numpy() - model.first) / model.step).astype(int)
    expected[outlook, node] = table[ACTIVITY].to_numpy(float)
    return model._replace(issued=issued, outlooks=expected)


def _coefficients(gravity_field: pd.DataFrame, degree: int, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine coefficients (degree + 1, order + 1) of a field, 0 where the table has none."""
    c, s = np.zeros((degree + 1, order + 1)), np.zeros((degree + 1, order + 1))
    used = gravity_field[(gravity_field["n"] <= degree) & (gravity_field["m"] <= order)]
    c[used["n"], used["m"]] = used["c"]
    s[used["n"], used["m"]] = used["s"]
    return c, s
