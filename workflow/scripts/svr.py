"""Draw true, ML-predicted and residual errors of one evaluation, absolute and signed."""

from opml.figures import context, errors, style
from opml.jobs import job
from opml.learning.cleaning import Cleaning
from opml.tables import read_table

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    evaluation = read_table(files.evaluation[0], "evaluation")
    told = context.of_experiment(
        settings,
        read_table(files.metrics[0], "metrics"),
        read_table(files.dataset[0], "dataset"),
        Cleaning.from_settings(settings["cleaning"]),
    )
    figures = [
        draw(evaluation, component=settings["component"], context=told)
        for draw in (errors.svr_absolute, errors.svr_signed)
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
