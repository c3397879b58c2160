"""Predict from each estimate to every later track start within reach."""

from opml.catalog.predict import prediction
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings):
    max_days: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    table = prediction.predict_all(
        Propagator.read(files, settings, threads=snakemake.threads, progress=progress),
        read_table(files.truth, "truth") if files.truth else None,
        read_table(files.estimates, "estimates"),
        max_days=settings.max_days,
    )
    write_table(snakemake.output[0], table, "predictions", metadata=metadata)
