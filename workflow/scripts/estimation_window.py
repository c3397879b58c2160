"""Draw the tracks that one estimate is made of."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.figures import orbit, style
from opml.figures.display_names import describe_run
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    stations: str
    window_day: float
    window_hours: float


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    tracking = read_table(snakemake.input[0], "tracking")
    track = tracking.loc[tracking["t"] >= DAY * settings.window_day, "track"].min()
    note = f"{describe_run(settings.rso, settings.stations)}; bars: tracks, from first to last measurement"
    figure = orbit.estimation_window(
        tracking, track=int(track), window_hours=settings.window_hours, note=note
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
