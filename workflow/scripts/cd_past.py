"""Gather the past of the Cd of fits over another window, beside each prediction."""

from opml.base.section import JobSettings
from opml.catalog.predict import other_windows
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    window_hours: float
    cd: float
    memory_days: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    table = other_windows.build_past(
        read_table(files.predictions, "predictions"),
        arc_estimates=other_windows.read_estimates(files, window_hours=settings.window_hours),
        apriori=settings.cd,
        memory_days=settings.memory_days,
    )
    write_table(snakemake.output[0], table, "cd_past", metadata=metadata)
