"""Read the gravity field and freeze it at the epoch."""

from opml.environment import gravity_field
from opml.tables import write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    field = gravity_field.read_icgem(gravity_field.resolve(settings.source))
    field = field.truncate(settings.degree, settings.order)
    metadata |= gravity_field.metadata(field)
    write_table(
        snakemake.output[0], gravity_field.table(field, settings.epoch), "gravity_field", metadata=metadata
    )
