"""Tabulate the space weather as it was forecast at each time of issue."""

from opml.base.constants import DAY
from opml.environment import known_weather, nodes
from opml.environment.forecasts import regression
from opml.tables import OUTLOOKS, write_table
from opml.workflow.jobs import job


class Settings(known_weather.Issues):
    duration_days: float


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    table = known_weather.outlooks(settings, nodes(settings.epoch, DAY * settings.duration_days))
    metadata |= {"source": settings.source, "forecast": regression.NAME}
    write_table(snakemake.output[0], table, OUTLOOKS, metadata=metadata)
