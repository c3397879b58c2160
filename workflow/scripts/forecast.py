"""Make ephemerides of predictions under a forecast, with what futures of the weather make of them."""

from opml.ephemerides import forecast
from opml.ephemerides.ephemeris_task import Task, TaskSettings
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(TaskSettings):
    seed: int


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    task = Task.read(files, settings, threads=snakemake.threads, progress=progress)
    table = forecast.build(task, read_table(files.futures, "futures"), seed=settings.seed)
    write_table(snakemake.output[0], table, "forecast", metadata=metadata)
