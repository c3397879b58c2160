"""Take an orbit of one's own for the true orbit of an RSO."""

from opml.base.constants import DAY
from opml.interop import truth_from_orbit
from opml.tables import write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table, told = truth_from_orbit.truth(
        list(snakemake.input),
        epoch=settings["epoch"],
        step=settings["step_s"],
        duration=DAY * settings["duration_days"],
    )
    write_table(snakemake.output[0], table, "truth", metadata=metadata | told)
