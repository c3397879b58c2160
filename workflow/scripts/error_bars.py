"""Draw mean and spread of the absolute errors of one evaluation."""

from opml.figures import notes, prediction_errors, style
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
    figure = prediction_errors.errorbar_absolute(
        read_table(files.evaluation[0], "evaluation"),
        component=settings.component,
        context=notes.read_context(settings.values, files.metrics[0], files.dataset[0]),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
