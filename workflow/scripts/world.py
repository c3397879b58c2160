"""Draw a day of ground tracks, the passes that were tracked, and what each station sees."""

from opml.base.section import JobSettings
from opml.figures import ground_tracks, style
from opml.figures.display_names import describe_run
from opml.orbits.sheets import Station
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    stations: str
    radars: list[Station]
    first_day: float
    epoch: str


with job(snakemake):
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    orbit = ground_tracks.ObservedOrbit(
        read_table(files.truth, "truth"),
        read_table(files.earth_orientation, "earth_orientation"),
        settings.radars,
    )
    figure = ground_tracks.world(
        orbit,
        read_table(files.tracking, "tracking"),
        first_day=settings.first_day,
        note=describe_run(settings.rso, settings.stations),
        epoch=settings.epoch,
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
