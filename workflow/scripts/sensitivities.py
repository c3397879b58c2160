"""Compute how each prediction answers to the drag coefficient."""

from opml.catalog.predict.sensitivity import sensitivities
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = PropagatorSettings(**snakemake.params.settings), snakemake.input
    table = sensitivities(
        Propagator.read(files, settings, threads=snakemake.threads, progress=progress),
        read_table(files.estimates, "estimates"),
        read_table(files.predictions, "predictions"),
    )
    write_table(snakemake.output[0], table, "sensitivities", metadata=metadata)
