"""Write ephemerides as CCSDS's orbit ephemeris messages, one of each estimate that they start from."""

from opml.base.section import JobSettings
from opml.interop import object_ids, oem
from opml.tables import read_metadata, read_runs
from opml.workflow.jobs import job


class Settings(JobSettings):
    table: str
    rso: str
    epoch: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    oem.write_each(
        snakemake.output[0],
        read_runs(snakemake.input[0], settings.table, "i"),
        settings.table,
        identity=object_ids.of_tables(snakemake.input.source, name=settings.rso),
        epoch=settings.epoch,
        comment=read_metadata(snakemake.input[0]).get("covariance", ""),
    )
