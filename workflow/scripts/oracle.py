"""Tell which part of each prediction's error comes from what."""

from opml.catalog.simulate import oracle
from opml.tables import read_metadata, read_table, write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    files = snakemake.input
    table = oracle.build(
        read_table(files.estimates, "estimates"),
        read_table(files.predictions, "predictions"),
        read_table(files.perfect, "estimates"),
        read_table(files.perfect_predictions, "predictions"),
        gm=read_metadata(files.gravity_field)["gm"],
    )
    write_table(snakemake.output[0], table, "oracle", metadata=metadata)
