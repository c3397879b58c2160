"""Run the mornings of some objects up to a day."""

from opml.mornings import batch, outcomes
from opml.mornings.batch import BatchSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = BatchSettings(**snakemake.params.settings)
    outcomes.write(
        snakemake.output[0],
        batch.run(snakemake.input, settings, metadata=metadata),
    )
