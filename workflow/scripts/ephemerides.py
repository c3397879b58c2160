"""Tabulate the third bodies on the environment's time grid."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.environment import celestial_bodies, nodes
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    kernel: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = celestial_bodies.tabulate(settings.kernel, settings.epoch, t)
    metadata |= celestial_bodies.metadata(settings.kernel)
    write_table(snakemake.output[0], table, "ephemerides", metadata=metadata)
