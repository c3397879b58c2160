"""Put the true states in the place of estimates."""

from opml.catalog.simulate import oracle
from opml.tables import read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    table = oracle.perfect(
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.truth, "truth"),
        cd=JobSettings(snakemake.params.settings).cd,
    )
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
