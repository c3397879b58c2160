"""Propagate the true orbit of an RSO."""

from opml.base.constants import DAY
from opml.catalog.simulate import truth
from opml.dynamics import force_model
from opml.orbits.sheets import Rso
from opml.tables import write_table
from opml.workflow.jobs import job, progress

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
