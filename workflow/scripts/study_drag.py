"""Draw the estimated drag coefficients beside the solar activity of the same days, above the errors."""

import pandas as pd

from opml.figures import own_study, style
from opml.figures.axis_labels import with_weather
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    estimates = {
        name: read_table(path, "estimates")
        for name, path in zip(settings["windows"], files.estimates, strict=True)
    }
    dataset = read_table(files.dataset, "dataset")
    errors = [
        own_study.daily_errors(dataset, component=settings["component"], day=day) for day in settings["marks"]
    ]
    figure = own_study.drag(
        estimates,
        read_table(files.activity, "solar_activity"),
        pd.concat(errors),
        note=with_weather(f"{settings['rso']} by {settings['stations']}; {own_study.UNCORRECTED}", settings),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
