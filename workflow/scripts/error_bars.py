"""Draw mean and spread of the absolute errors of one evaluation."""

from opml.figures import errors, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    evaluation = read_table(snakemake.input[0], "evaluation")
    figure = errors.errorbar_absolute(evaluation, component=snakemake.params.settings["component"])
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
