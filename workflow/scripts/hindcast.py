"""Tabulate the space weather as it was known at each time of the environment's grid."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.environment import known_weather, nodes
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    knowledge: str
    source: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = known_weather.TABLES[settings.knowledge](settings.source, settings.epoch, t)
    metadata |= {"source": settings.source}
    write_table(snakemake.output[0], table, "solar_activity", metadata=metadata)
