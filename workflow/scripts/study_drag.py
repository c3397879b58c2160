"""Draw the estimated drag coefficients beside the solar activity of the same days, above the errors."""

import pandas as pd

from opml.figures import study, style
from opml.figures.labels import with_weather
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    estimates = {
        name: read_table(path, "estimates")
        for name, path in zip(settings["windows"], files.estimates, strict=True)
    }
    dataset = read_table(files.dataset, "dataset")
    errors = [
        study.daily_errors(dataset, component=settings["component"], day=day) for day in settings["marks"]
    ]
    figure = study.drag(
        estimates,
        read_table(files.activity, "solar_activity"),
        pd.concat(errors),
        note=with_weather(f"{settings['rso']} by {settings['stations']}; {study.UNCORRECTED}", settings),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
