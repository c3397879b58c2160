"""Draw the size of the errors before and after correction, one panel per model."""

from opml.figures import study, style
from opml.figures.labels import experiment, with_weather
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    tables = {
        name: read_table(path, "evaluation")
        for name, path in zip(settings["learners"], snakemake.input, strict=True)
    }
    figure = study.errors(
        tables, component=settings["component"], note=with_weather(experiment(**settings), settings)
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
