"""Tabulate the orientation of Earth on the environment's time grid."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.environment import earth_orientation, nodes
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = earth_orientation.tabulate(settings.epoch, t)
    metadata |= earth_orientation.metadata()
    write_table(snakemake.output[0], table, "earth_orientation", metadata=metadata)
