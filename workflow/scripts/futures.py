"""Tabulate the space weather as it may come, by so many futures about the forecast."""

from opml.base.constants import DAY
from opml.environment import known_weather, nodes
from opml.environment.forecasts import regression
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(known_weather.Issues):
    duration_days: float
    members: int


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = known_weather.tabulate_futures(settings, t, members=settings.members)
    metadata |= {"source": settings.source, "forecast": regression.NAME, "members": settings.members}
    write_table(snakemake.output[0], table, "futures", metadata=metadata)
