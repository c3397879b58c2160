"""Propagate the true orbits of RSOs that fly together."""

from opml.catalog import force_model, truth
from opml.constants import DAY
from opml.jobs import job, progress
from opml.sheets import Rso
from opml.tables import FLOWN_WITH, write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    rsos = [Rso(**rso) for rso in settings["rsos"]]
    tables = truth.simulate_together(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        rsos,
        duration=DAY * settings["duration_days"],
        step=settings["step_s"],
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    metadata[FLOWN_WITH] = [rso.name for rso in rsos]
    for path, table in zip(snakemake.output, tables, strict=True):
        write_table(path, table, "truth", metadata=metadata)
