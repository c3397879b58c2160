"""Make corrected ephemerides on a regular grid ahead of estimates."""

from opml import corrected
from opml.constants import DAY
from opml.jobs import job, progress
from opml.learning import learners, stated
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    known = corrected.read(files, settings)
    step, max_days, duration_days = settings["grid"]
    until = DAY * settings["known_until_days"]
    table = corrected.build(
        corrected.Flight.read(files, settings, threads=snakemake.threads),
        known,
        learners.read(files.model),
        stated.read(files.stated, trained_until=until),
        corrected.departures(known, known_until=until, each=settings["from"] == "each"),
        corrected.Grid(step, max_days, DAY * duration_days),
        progress=progress,
    )
    write_table(snakemake.output[0], table, "corrected", metadata=metadata)
