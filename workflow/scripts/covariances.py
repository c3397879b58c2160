"""Carry the covariance of each estimate to its predictions."""

from opml.catalog import force_model
from opml.catalog.covariance import covariances
from opml.jobs import job, progress
from opml.sheets import Rso
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings = snakemake.params.settings
    table = covariances(
        force_model.read(snakemake.input, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.predictions, "predictions"),
        Rso(**settings["rso"]),
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output[0], table, "covariances", metadata=metadata)
