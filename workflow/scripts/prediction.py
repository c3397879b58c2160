"""Predict from each estimate to every later track start within reach."""

from opml.catalog.predict import prediction
from opml.dynamics import force_model
from opml.orbits.sheets import Rso
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = prediction.predict_all(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(snakemake.input.truth, "truth") if snakemake.input.truth else None,
        read_table(snakemake.input.estimates, "estimates"),
        Rso(**settings["rso"]),
        max_days=settings["max_days"],
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "predictions", metadata=metadata)
