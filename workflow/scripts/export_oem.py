"""Write an orbit as CCSDS's orbit ephemeris message."""

from opml.base.section import JobSettings
from opml.interop import object_ids, oem
from opml.tables import read_metadata, read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    table: str
    rso: str
    epoch: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    table = read_table(snakemake.input[0], settings.table)
    identity = object_ids.of_tables(snakemake.input.source, name=settings.rso)
    segments = oem.segments_of(table, settings.table, identity)
    comment = read_metadata(snakemake.input[0]).get("covariance", "")
    oem.write(snakemake.output[0], segments, epoch=settings.epoch, comment=comment)
