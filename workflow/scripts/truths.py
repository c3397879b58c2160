"""Propagate the true orbits of a catalogue together."""

from opml.catalog import force_model, truth
from opml.constants import DAY
from opml.jobs import job, progress
from opml.sheets import Rso
from opml.tables import write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    tables = truth.simulate_together(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        [Rso(**rso) for rso in settings["rsos"]],
        duration=DAY * settings["duration_days"],
        step=settings["step_s"],
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    for path, table in zip(snakemake.output, tables, strict=True):
        write_table(path, table, "truth", metadata=metadata)
