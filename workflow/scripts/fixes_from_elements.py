"""Take what SGP4 tells before the epochs of mean elements for the tracks of an RSO."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.catalog.fit import fixes
from opml.interop.element_sets import burns_in_sets, measured_sets
from opml.interop.element_sets.measured_sets import HistoryTaking
from opml.orbits import manoeuvres
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    taking: HistoryTaking
    duration_days: float
    manoeuvres: list[str]
    epoch: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    taking, duration = settings.taking, DAY * settings.duration_days
    sets = measured_sets.of_run(read_table(snakemake.input[0], "element_sets"), duration)
    named = manoeuvres.at_times(settings.manoeuvres, epoch=settings.epoch)
    known = burns_in_sets.manoeuvres_of(sets, named, epoch=settings.epoch, find=taking.find_manoeuvres)
    measured = measured_sets.measured(
        sets,
        taking.of_sets,
        epoch=settings.epoch,
        duration=duration,
        manoeuvres=known,
    )
    table = fixes.of_sets(measured.epochs, measured.points, known=measured.known)
    write_table(snakemake.output[0], table, "fixes", metadata=metadata | manoeuvres.facts(known))
