"""Draw alarms per collision and the share of collisions that is flagged, by prediction duration."""

from opml.base.section import JobSettings
from opml.figures import alarms, style
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    note: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    figure = alarms.by_duration(read_table(snakemake.input[0], "conjunctions"), note=settings.note)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
