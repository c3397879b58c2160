"""Draw true, ML-predicted and residual errors of one evaluation, absolute and signed."""

from opml.base.section import JobSettings
from opml.figures import notes, prediction_errors, style
from opml.learning.data.cleaning import Cleaning
from opml.naming import Experiment
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    experiment: Experiment
    cleaning: Cleaning


with job(snakemake):
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    evaluation = read_table(files.evaluation[0], "evaluation")
    context = notes.read_context(settings.experiment, settings.cleaning, files.metrics[0], files.dataset[0])
    figures = [
        draw(evaluation, component=settings.experiment.component, context=context)
        for draw in (prediction_errors.svr_absolute, prediction_errors.svr_signed)
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
