"""Put the true states in the place of estimates."""

from opml.base.section import JobSettings
from opml.catalog.simulate import oracle
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    cd: float


with job(snakemake) as metadata:
    table = oracle.perfect(
        read_table(snakemake.input.estimates, "estimates"),
        read_table(snakemake.input.truth, "truth"),
        cd=Settings(**snakemake.params.settings).cd,
    )
    write_table(snakemake.output[0], table, "estimates", metadata=metadata)
