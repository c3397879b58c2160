"""Write an orbit as CCSDS's orbit ephemeris message."""

from opml.interop import oem
from opml.tables import read_metadata, read_table
from opml.workflow.job_settings import SheetJobSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = SheetJobSettings(snakemake.params.settings)
    table = read_table(snakemake.input[0], settings.table)
    segments = oem.SEGMENTS[settings.table](table, rso=settings.rso)
    comment = read_metadata(snakemake.input[0]).get("covariance", "")
    oem.write(snakemake.output[0], segments, epoch=settings.epoch, comment=comment)
