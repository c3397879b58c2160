"""Hold predictions against later estimates."""

from opml.catalog.predict import labels
from opml.tables import read_measured, read_table, write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    table = labels.build(
        read_table(snakemake.input.predictions, "predictions"),
        read_table(snakemake.input.estimates, "estimates"),
        read_measured(snakemake.input.tracking),
    )
    write_table(snakemake.output[0], table, "labels", metadata=metadata)
