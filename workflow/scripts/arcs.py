"""Gather what fits over another window say of each prediction."""

from opml.catalog.predict import other_windows
from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(PropagatorSettings):
    window_hours: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    table = other_windows.build_arcs(
        Propagator.read(files, settings, threads=snakemake.threads, progress=progress),
        read_table(files.predictions, "predictions"),
        arc_estimates=other_windows.read_estimates(files, window_hours=settings.window_hours),
        arc_predictions=read_table(files.arc_predictions, "predictions"),
    )
    write_table(snakemake.output[0], table, "arcs", metadata=metadata)
