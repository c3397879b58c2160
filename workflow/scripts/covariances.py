"""Carry the covariance of each estimate to its predictions."""

from opml.catalog.predict import covariance
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings = PropagatorSettings(**snakemake.params.settings)
    predictions = read_table(snakemake.input.predictions, "predictions")
    carried = covariance.propagated(
        Propagator.read(
            snakemake.input,
            settings,
            threads=snakemake.threads,
            progress=progress,
        ),
        read_table(snakemake.input.estimates, "estimates"),
        predictions,
    )
    table = covariance.of_positions(predictions, carried)
    write_table(snakemake.output[0], table, "covariances", metadata=metadata)
