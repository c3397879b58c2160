"""Draw a day of ground tracks, the passes that were tracked, and what each station sees."""

from opml.figures import ground, style
from opml.figures.display_names import describe_run
from opml.orbits.sheets import Station
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
    orbit = ground.ObservedOrbit(
        read_table(files.truth, "truth"),
        read_table(files.earth_orientation, "earth_orientation"),
        [Station(**station) for station in settings.radars],
    )
    figure = ground.world(
        orbit,
        read_table(files.tracking, "tracking"),
        first_day=settings.first_day,
        note=describe_run(settings.values),
        epoch=settings.epoch,
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
