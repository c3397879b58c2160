"""Draw the estimated drag coefficients beside the solar activity of the same days, above the errors."""

import pandas as pd

from opml.base.section import JobSettings
from opml.figures import own_study, style
from opml.figures.axis_labels import lines
from opml.figures.display_names import describe_run
from opml.orbits.manoeuvres import read_manoeuvres
from opml.tables import read_table
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    rso: str
    stations: str
    component: str
    marks: list[float]
    windows: list[str]
    epoch: str
    weather: str


with job(snakemake):
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    dataset = read_table(files.dataset, "dataset")
    errors = [
        own_study.daily_errors(dataset, component=settings.component, day=day) for day in settings.marks
    ]
    figure = own_study.drag_figure(
        read_by_key(settings.windows, files.estimates, "estimates"),
        read_table(files.activity, "solar_activity"),
        pd.concat(errors),
        epoch=settings.epoch,
        manoeuvres=[one.t for one in read_manoeuvres(files.manoeuvres)] if files.manoeuvres else [],
        note=lines(
            f"{describe_run(settings.rso, settings.stations)}; {own_study.UNCORRECTED_NOTE}", settings.weather
        ),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
