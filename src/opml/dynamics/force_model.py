"""The force model and the integrator of a run, from the environment's tables and the settings."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from opml.dynamics.forces import build, with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.run_environment import Environment
from opml.tables import ENVIRONMENT, OPTIONAL, OUTLOOKS, THERMOSPHERE, read_metadata, read_table


def read(paths: Mapping[str, str], *, epoch: str, settings: Mapping[str, Any]) -> ForceModel:
    """Read a force model.

    paths: of the tables in `tables.ENVIRONMENT`, by name, and those in `tables.OPTIONAL` where there are any;
    epoch: UTC text; settings: degree, order, third_bodies, and solid_tides and relativity where they are
    on. Raises InputError where a table is missing or damaged, and for a field that tides cannot be added to.
    """
    field = read_metadata(paths["gravity_field"])
    environment = Environment(
        epoch,
        **{name: read_table(paths[name], name) for name in ENVIRONMENT},
        gm=field["gm"],
        radius=field["radius"],
        gms=read_metadata(paths["ephemerides"])["gm"],
        tide_system=field["tide_system"],
    )
    optional = {name: read_table(paths[name], name) for name in OPTIONAL if name in dict(paths.items())}
    model = of_settings(environment, settings, thermosphere=optional.get(THERMOSPHERE))
    return with_outlooks(model, optional[OUTLOOKS]) if OUTLOOKS in optional else model


def of_settings(
    environment: Environment, settings: Mapping[str, Any], *, thermosphere: pd.DataFrame | None = None
) -> ForceModel:
    """Make a force model from an environment; settings: as for `read`, thermosphere: as for `build`."""
    return build(
        environment,
        degree=settings["degree"],
        order=settings["order"],
        bodies=settings["third_bodies"],
        solid_tides=settings.get("solid_tides", False),
        relativity=settings.get("relativity", False),
        thermosphere=thermosphere,
    )
