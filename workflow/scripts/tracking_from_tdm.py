"""Take tracks that were really measured for those of an RSO."""

from opml.catalog.fit import measured_tracks
from opml.interop import tdm
from opml.orbits import manoeuvres
from opml.orbits.sheets import Station
from opml.tables import write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    table = measured_tracks.tracks(
        tdm.measurements(list(snakemake.input), epoch=settings.epoch),
        [Station(**station) for station in settings.stations],
    )
    metadata |= manoeuvres.facts(manoeuvres.at_times(settings.manoeuvres, epoch=settings.epoch))
    write_table(snakemake.output[0], table, "tracking", metadata=metadata)
