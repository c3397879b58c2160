"""Draw one prediction under many futures of the space weather."""

from opml.base.section import JobSettings
from opml.figures import style, weather_fan
from opml.figures.display_names import describe_run
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    stations: str
    track: int
    level: float


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    figure = weather_fan.chart(
        read_table(snakemake.input.fan, "fan"),
        read_table(snakemake.input.sample, "ensemble"),
        track=settings.track,
        level=settings.level,
        note=f"{describe_run(settings.rso, settings.stations)}, from track {settings.track}",
    )
    style.save_all([figure], [snakemake.output.pdf], [snakemake.output.png])
