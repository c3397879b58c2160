"""Tabulate solar and geomagnetic activity on the environment's time grid."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.environment import nodes, solar_activity
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    source: str
    percentile: int


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = solar_activity.tabulate(settings.source, settings.epoch, t, settings.percentile)
    metadata |= {"source": settings.source, "percentile": settings.percentile}
    write_table(snakemake.output[0], table, "solar_activity", metadata=metadata)
