"""Draw true, ML-predicted and residual errors of one evaluation, absolute and signed."""

from opml.figures import notes, prediction_errors, style
from opml.learning.data.cleaning import Cleaning
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    context = notes.experiment_context(
        settings,
        read_table(files.metrics[0], "metrics"),
        read_table(files.dataset[0], "dataset"),
        Cleaning.from_settings(settings["cleaning"]),
    )
    evaluation = read_table(files.evaluation[0], "evaluation")
    figures = [
        draw(evaluation, component=settings["component"], context=context)
        for draw in (prediction_errors.svr_absolute, prediction_errors.svr_signed)
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
