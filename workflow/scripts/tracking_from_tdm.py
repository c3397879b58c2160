"""Take tracks that were really measured for those of an RSO."""

from opml.base.section import JobSettings
from opml.catalog.fit import measured_tracks
from opml.interop import object_ids, tdm
from opml.orbits import manoeuvres
from opml.orbits.sheets import Station
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    stations: list[Station]
    manoeuvres: list[str]


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    found = tdm.measurements(list(snakemake.input), epoch=settings.epoch)
    table = measured_tracks.tracks(found, settings.stations)
    metadata |= manoeuvres.facts(manoeuvres.at_times(settings.manoeuvres, epoch=settings.epoch))
    metadata |= object_ids.facts(tdm.identity(found))
    write_table(snakemake.output[0], table, "tracking", metadata=metadata)
