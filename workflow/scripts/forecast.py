"""Make ephemerides of predictions under a forecast, with what futures of the weather make of them."""

from opml.ephemerides import corrected, forecast
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    flight, known, starts, grid = corrected.task(files, settings, threads=snakemake.threads)
    table = forecast.build(
        flight,
        known,
        read_table(files.futures, "futures"),
        starts,
        grid,
        seed=settings["seed"],
        progress=progress,
    )
    write_table(snakemake.output[0], table, "forecast", metadata=metadata)
