"""Tell what the predictions of a study's mornings are worth where objects may collide."""

from opml.conjunctions import collision_alarms
from opml.tables import read_table, write_table
from opml.workflow.jobs import job
from opml.workflow.replayed_mornings import ReplayedSettings, read_mornings


class Settings(ReplayedSettings):
    radius_m: float
    threshold: float
    weather: str


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    table = collision_alarms.compare(
        read_mornings(files, settings),
        read_table(files.fits, "covariances"),
        collision_alarms.Screening(settings.radius_m, settings.threshold),
        weather=settings.weather,
        laws=settings.laws,
        days=settings.days,
        seed=settings.seed,
    )
    write_table(snakemake.output[0], table, "conjunctions", metadata=metadata)
