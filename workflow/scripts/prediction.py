"""Predict from each estimate to every later track start within reach."""

from opml.catalog import force_model, prediction
from opml.jobs import job, progress
from opml.sheets import Rso
from opml.tables import read_table, write_table

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
