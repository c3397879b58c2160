"""Tabulate mean densities of the thermosphere since 2002 under measured weather."""

from opml.base.section import JobSettings
from opml.element_sets import corrector_trial
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    weather: str


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    densities = corrector_trial.densities(settings.weather)
    write_table(snakemake.output[0], densities, corrector_trial.DENSITIES, metadata=metadata)
