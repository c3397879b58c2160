"""Make corrected ephemerides on a regular grid ahead of estimates."""

from opml import corrected
from opml.constants import DAY
from opml.jobs import job, progress
from opml.learning import learners, stated
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    flight, known, starts, grid = corrected.task(files, settings, threads=snakemake.threads)
    table = corrected.build(
        flight,
        known,
        learners.read(files.model),
        stated.read(files.stated, trained_until=DAY * settings["known_until_days"]),
        starts,
        grid,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "corrected", metadata=metadata)
