"""Carry the covariance of each estimate to its predictions."""

from opml.catalog.predict import covariance
from opml.dynamics import force_model
from opml.orbits.sheets import Rso
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    predictions = read_table(snakemake.input.predictions, "predictions")
    carried = covariance.propagated(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(snakemake.input.estimates, "estimates"),
        predictions,
        Rso(**settings["rso"]),
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    table = covariance.of_positions(predictions, carried)
    write_table(snakemake.output[0], table, "covariances", metadata=metadata)
