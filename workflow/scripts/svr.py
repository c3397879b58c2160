"""Draw true, ML-predicted and residual errors of one evaluation, absolute and signed."""

from opml.figures import errors, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    evaluation = read_table(snakemake.input[0], "evaluation")
    component = snakemake.params.settings["component"]
    figures = [draw(evaluation, component=component) for draw in (errors.svr_absolute, errors.svr_signed)]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
