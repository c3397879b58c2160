"""Draw a day of ground tracks, the passes that were tracked, and what each station sees."""

from opml.figures import ground, style
from opml.orbits.sheets import Station
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    figure = ground.world(
        read_table(files.truth, "truth"),
        read_table(files.tracking, "tracking"),
        read_table(files.earth_orientation, "earth_orientation"),
        [Station(**one) for one in settings["radars"]],
        first_day=settings["first_day"],
        note=f"{settings['rso']} by {settings['stations']}",
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
