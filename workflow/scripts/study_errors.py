"""Draw the size of the errors before and after correction, one panel per model."""

from opml.figures import own_study, style
from opml.figures.axis_labels import add_weather, describe_experiment
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    figure = own_study.errors(
        read_by_key(settings.learners, snakemake.input, "evaluation"),
        component=settings.component,
        note=add_weather(describe_experiment(settings.values), settings.values),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
