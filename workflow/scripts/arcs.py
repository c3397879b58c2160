"""Gather what fits over another window, and the past of their Cd, say of each prediction."""

from opml.base.constants import HOUR
from opml.catalog.flight import Flight
from opml.catalog.predict import other_windows
from opml.tables import read_metadata, read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = JobSettings(snakemake.params.settings), snakemake.input
    manoeuvres = read_metadata(files.manoeuvres).get("manoeuvres", [])
    arc_estimates = other_windows.undisturbed(
        read_table(files.arc_estimates, "estimates"),
        manoeuvres=[manoeuvre["t"] for manoeuvre in manoeuvres],
        window=HOUR * settings.window_hours,
    )
    table = other_windows.build(
        Flight.read(files, settings.values, threads=snakemake.threads, progress=progress),
        read_table(files.predictions, "predictions"),
        arc_estimates=arc_estimates,
        arc_predictions=read_table(files.arc_predictions, "predictions"),
        memory_days=settings.memory_days,
    )
    write_table(snakemake.output[0], table, "arcs", metadata=metadata)
