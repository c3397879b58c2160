"""Read the gravity field and freeze it at the epoch."""

from opml.base.section import JobSettings
from opml.environment import gravity_field
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    source: str
    degree: int
    order: int
    epoch: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    field = gravity_field.read_icgem(gravity_field.resolve(settings.source))
    field = field.truncate(settings.degree, settings.order)
    metadata |= gravity_field.metadata(field)
    write_table(
        snakemake.output[0], gravity_field.table(field, settings.epoch), "gravity_field", metadata=metadata
    )
