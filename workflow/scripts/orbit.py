"""Draw the orbit with its observations, and its osculating elements."""

from opml.base.section import JobSettings
from opml.figures import orbit, style
from opml.figures.display_names import describe_run, display_rso
from opml.tables import read_metadata, read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    stations: str
    days: tuple[float, float]
    zoom_days: tuple[float, float]


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    truth, tracking = (
        orbit.select_days(read_table(snakemake.input[name], name), settings.days)
        for name in ("truth", "tracking")
    )
    gm = read_metadata(snakemake.input.gravity_field)["gm"]
    observed = describe_run(settings.rso, settings.stations)
    elements = f"{display_rso(settings.rso)}: osculating elements in GCRF"
    figures = [
        orbit.orbit_3d(truth, tracking, note=observed),
        orbit.orbital_elements(truth, gm=gm, zoom_days=settings.zoom_days, note=elements),
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
