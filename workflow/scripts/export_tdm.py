"""Write tracks as CCSDS's tracking data message."""

from opml.base.section import JobSettings
from opml.interop import tdm
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    rso: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    tracking = read_table(snakemake.input[0], "tracking")
    tdm.write(snakemake.output[0], tracking, epoch=settings.epoch, rso=settings.rso)
