"""Draw the size of the errors before and after correction, one panel per model."""

from opml.figures import own_study, style
from opml.figures.axis_labels import experiment, with_weather
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings = snakemake.params.settings
    tables = {
        name: read_table(path, "evaluation")
        for name, path in zip(settings["learners"], snakemake.input, strict=True)
    }
    figure = own_study.errors(
        tables, component=settings["component"], note=with_weather(experiment(**settings), settings)
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
