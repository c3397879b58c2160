"""Hold predictions against later estimates."""

from opml.catalog import labels
from opml.constants import HOUR
from opml.jobs import job
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    table = labels.build(
        read_table(snakemake.input.predictions, "predictions"),
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.tracking, "tracking"),
        after=HOUR * snakemake.params.settings["after_hours"],
    )
    write_table(snakemake.output[0], table, "labels", metadata=metadata)
