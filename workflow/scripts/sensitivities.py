"""Compute how each prediction answers to the drag coefficient."""

from opml.catalog.flight import Flight
from opml.catalog.predict.sensitivity import sensitivities
from opml.tables import read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = JobSettings(snakemake.params.settings), snakemake.input
    table = sensitivities(
        Flight.read(files, settings.values, threads=snakemake.threads, progress=progress),
        read_table(files.estimates, "estimates"),
        read_table(files.predictions, "predictions"),
        bounds=settings.cd_bounds,
    )
    write_table(snakemake.output[0], table, "sensitivities", metadata=metadata)
