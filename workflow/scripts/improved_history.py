"""Improve the sets of an RSO's mean elements, each as it could be when it was known."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.element_sets import improved_history
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    weather: str


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    sets = read_table(files.element_sets, "element_sets")
    table = improved_history.history(
        improved_history.ImprovedHistory.read(files.catalogue, settings.weather),
        sets[sets["t"].between(0.0, DAY * settings.duration_days)],
        epoch=settings.epoch,
    )
    write_table(snakemake.output[0], table, "improved_history", metadata=metadata)
