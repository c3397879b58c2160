"""Draw mean and spread of the absolute errors of one evaluation."""

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
    figure = prediction_errors.errorbar_absolute(
        read_table(files.evaluation[0], "evaluation"),
        component=settings.experiment.component,
        context=notes.read_context(
            settings.experiment, settings.cleaning, files.metrics[0], files.dataset[0]
        ),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
