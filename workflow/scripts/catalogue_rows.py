"""Predict, by SGP4, the mornings of two seasons, and see what the corrector sees of each prediction."""

from opml.base.section import JobSettings
from opml.element_sets import corrector_trial
from opml.tables import SCHEMAS, read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    seasons: dict[str, list[str]]
    weather: str
    latency_hours: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    rows = corrector_trial.rows(
        files.sets,
        read_table(files.densities, corrector_trial.DENSITIES),
        corrector_trial.Seasons.of_dates(**settings.seasons),
        orbits=read_table(files.orbits[0], "set_states") if files.orbits else SCHEMAS["set_states"].empty(),
        weather=settings.weather,
        latency=settings.latency_hours / 24.0,
    )
    write_table(snakemake.output[0], rows, corrector_trial.ROWS, metadata=metadata)
