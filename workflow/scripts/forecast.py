"""Make ephemerides of predictions under a forecast, with what futures of the weather make of them."""

from opml import corrected, forecasted
from opml.constants import DAY
from opml.jobs import job, progress
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    known = corrected.read(files, settings)
    step, max_days, duration_days = settings["grid"]
    until = DAY * settings["known_until_days"]
    table = forecasted.build(
        corrected.Flight.read(files, settings, threads=snakemake.threads),
        known,
        read_table(files.futures, "futures"),
        corrected.departures(known, known_until=until, each=settings["from"] == "each"),
        corrected.Grid(step, max_days, DAY * duration_days),
        seed=settings["seed"],
        progress=progress,
    )
    write_table(snakemake.output[0], table, "forecast", metadata=metadata)
