"""Draw one prediction under many futures of the space weather."""

from opml.figures import fan, style
from opml.figures.display_names import describe_run
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    figure = fan.chart(
        read_table(snakemake.input.fan, "fan"),
        read_table(snakemake.input.sample, "ensemble"),
        track=settings.track,
        level=settings.level,
        note=f"{describe_run(settings.values)}, from track {settings.track}",
    )
    style.save_all([figure], [snakemake.output.pdf], [snakemake.output.png])
