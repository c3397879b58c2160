"""The force model of a job, from the tables of its environment and the settings."""

from collections.abc import Mapping

from opml.dynamics.forces import build, with_outlooks
from opml.dynamics.kernels.surroundings import ForceModel
from opml.dynamics.run_environment import Environment
from opml.dynamics.settings import ForceModelSettings
from opml.tables import ENVIRONMENT, OUTLOOKS, read_metadata, read_table


def read(paths: Mapping[str, str], *, epoch: str, settings: ForceModelSettings) -> ForceModel:
    """Read a force model.

    paths: of the tables in `tables.ENVIRONMENT`, by name, and of the outlooks where there are any; epoch: UTC
    text. Raises InputError where a table is missing or damaged, and as `build` does.
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
    model = build(environment, settings)
    if OUTLOOKS not in dict(paths.items()):
        return model
    return with_outlooks(model, read_table(paths[OUTLOOKS], OUTLOOKS))
