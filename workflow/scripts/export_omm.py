"""Write mean elements of an ephemeris as CCSDS's orbit mean-elements message."""

from opml.base.section import JobSettings
from opml.interop import object_ids, oem
from opml.interop.element_sets import element_fits, omm
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    epoch: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    (ephemeris,) = oem.corrected_segments(read_table(snakemake.input[0], "corrected"), rso=settings.rso)
    satellite = element_fits.fit_ephemeris(ephemeris, epoch=settings.epoch)
    omm.write(
        snakemake.output[0],
        satellite,
        identity=object_ids.of_tables(snakemake.input.source, name=settings.rso),
        epoch=settings.epoch,
        comment=element_fits.residual(satellite, ephemeris, epoch=settings.epoch),
    )
