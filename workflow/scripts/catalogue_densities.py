"""Tabulate mean densities of the thermosphere since 2002 under measured weather."""

from opml.element_sets import held_out
from opml.tables import write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    densities = held_out.densities(settings.weather)
    write_table(snakemake.output[0], densities, held_out.DENSITIES, metadata=metadata)
