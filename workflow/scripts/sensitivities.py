"""Compute how each prediction answers to the drag coefficient."""

from opml.catalog.predict.sensitivity import sensitivities
from opml.dynamics import force_model
from opml.orbits.sheets import Rso
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = sensitivities(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.predictions, "predictions"),
        Rso(**settings["rso"]),
        bounds=settings["cd_bounds"],
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "sensitivities", metadata=metadata)
