"""Draw true, ML-predicted and residual errors of one evaluation, absolute and signed."""

from opml.figures import notes, prediction_errors, style
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
    evaluation = read_table(files.evaluation[0], "evaluation")
    context = notes.read_context(settings.values, files.metrics[0], files.dataset[0])
    figures = [
        draw(evaluation, component=settings.component, context=context)
        for draw in (prediction_errors.svr_absolute, prediction_errors.svr_signed)
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
