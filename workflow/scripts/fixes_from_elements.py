"""Take what SGP4 tells before the epochs of mean elements for the tracks of an RSO."""

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.catalog.fit import fixes
from opml.interop.element_sets import measured_sets
from opml.interop.element_sets.sgp4_points import Sampling
from opml.tables import read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    history = settings.history
    times = sorted(epochs.seconds_between(settings.epoch, time) for time in settings.manoeuvres)
    found = measured_sets.measured(
        read_table(snakemake.input[0], "element_sets"),
        measured_sets.Taking(Sampling(HOUR * history["reach_hours"], history["every_s"]), history["sigma_m"]),
        epoch=settings.epoch,
        duration=DAY * settings.duration_days,
        manoeuvres=times,
    )
    table = fixes.of_sets(found.epochs, found.points, known=found.known)
    metadata |= {"manoeuvres": [{"t": t} for t in times]}
    write_table(snakemake.output[0], table, "fixes", metadata=metadata)
