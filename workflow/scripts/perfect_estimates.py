"""Put the true states in the place of estimates."""

from opml.catalog import oracle
from opml.jobs import job
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    table = oracle.perfect(
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.truth, "truth"),
        cd=snakemake.params.settings["cd"],
    )
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
