"""Tabulate the third bodies on the environment's time grid."""

from opml.base.constants import DAY, GM
from opml.base.section import JobSettings
from opml.environment import celestial_bodies, nodes
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    t = nodes(settings.epoch, DAY * settings.duration_days)
    table = celestial_bodies.tabulate(settings.epoch, t)
    metadata |= {"kernel": "DE440", "gm": GM}
    write_table(snakemake.output[0], table, "ephemerides", metadata=metadata)
