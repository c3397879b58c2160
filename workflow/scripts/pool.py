"""Put tables of several RSOs below each other."""

from opml.base.section import JobSettings
from opml.learning.data import dataset
from opml.tables import SCHEMAS, mechanism_schema, read_kind, read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    resonances: list[tuple[int, int]]


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    kind = read_kind(snakemake.input[0])
    schema = mechanism_schema(settings.resonances) if kind == "mechanism" else SCHEMAS[kind]
    table = dataset.pool([read_table(path, schema) for path in snakemake.input])
    metadata |= {"resonances": settings.resonances}
    write_table(snakemake.output[0], table, schema, metadata=metadata)
