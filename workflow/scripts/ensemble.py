"""Predict under each of the futures of the space weather, and tell their spread."""

from opml.base.constants import HOUR
from opml.catalog.predict import weather_futures
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings):
    window_hours: float
    seed: int
    level: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    predictions = read_table(files.predictions, "predictions")
    sample = weather_futures.sample(
        Propagator.read(files, settings, threads=snakemake.threads, progress=progress),
        read_table(files.futures, "futures"),
        read_table(files.estimates, "estimates"),
        predictions,
        window=HOUR * settings.window_hours,
        seed=settings.seed,
    )
    write_table(snakemake.output.sample, sample, "ensemble", metadata=metadata)
    fan = weather_futures.fan(sample, predictions, level=settings.level)
    metadata |= {"level": settings.level}
    write_table(snakemake.output.fan, fan, "fan", metadata=metadata)
    write_table(snakemake.output.scores, weather_futures.scores(fan), "scores", metadata=metadata)
