"""Draw the estimated drag coefficients beside the solar activity of the same days, above the errors."""

import pandas as pd

from opml.figures import own_study, style
from opml.figures.axis_labels import add_weather
from opml.figures.display_names import describe_run
from opml.orbits.manoeuvres import read_manoeuvres
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
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
        note=add_weather(f"{describe_run(settings.values)}; {own_study.UNCORRECTED_NOTE}", settings.values),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
