"""Write tracks as CCSDS's tracking data message."""

from opml.interop import tdm
from opml.tables import read_table
from opml.workflow.job_settings import SheetJobSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = SheetJobSettings(snakemake.params.settings)
    tracking = read_table(snakemake.input[0], "tracking")
    tdm.write(snakemake.output[0], tracking, epoch=settings.epoch, rso=settings.rso)
