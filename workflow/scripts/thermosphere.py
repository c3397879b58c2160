"""Tabulate the densities of another atmosphere than DTM2000 on the environment's time grid."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.environment import nodes, nrlmsis
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    source: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = nrlmsis.tabulate(settings.source, settings.epoch, t)
    metadata |= {"source": settings.source, **nrlmsis.sources()}
    write_table(snakemake.output[0], table, "thermosphere", metadata=metadata)
