"""Take an orbit of one's own for the true orbit of an RSO."""

from opml.constants import DAY
from opml.interop import ephemeris
from opml.jobs import job
from opml.tables import write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table, told = ephemeris.truth(
        list(snakemake.input),
        epoch=settings["epoch"],
        step=settings["step_s"],
        duration=DAY * settings["duration_days"],
    )
    write_table(snakemake.output[0], table, "truth", metadata=metadata | told)
