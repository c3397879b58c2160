"""Draw mean and spread of the absolute errors of one evaluation."""

from opml.figures import context, errors, style
from opml.jobs import job
from opml.learning.cleaning import Cleaning
from opml.tables import read_table

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    told = context.of_experiment(
        settings,
        read_table(files.metrics[0], "metrics"),
        read_table(files.dataset[0], "dataset"),
        Cleaning.from_settings(settings["cleaning"]),
    )
    evaluation = read_table(files.evaluation[0], "evaluation")
    figure = errors.errorbar_absolute(evaluation, component=settings["component"], context=told)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
