"""Propagate the true orbit of an RSO."""

from opml.catalog import force_model, truth
from opml.constants import DAY
from opml.jobs import job, progress
from opml.sheets import Rso
from opml.tables import write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = truth.simulate(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        Rso(**settings["rso"]),
        duration=DAY * settings["duration_days"],
        step=settings["step_s"],
        integrator=force_model.integrator(settings["integrator"]),
        progress=progress,
    )
    write_table(snakemake.output[0], table, "truth", metadata=metadata)
