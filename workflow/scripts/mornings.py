"""Run the mornings of some objects up to a day."""

from opml.mornings import batch, outcomes
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    outcomes.write(snakemake.output[0], batch.run(snakemake.input, settings.values, metadata=metadata))
