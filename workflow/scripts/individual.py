"""Draw the individual performance metric: points made better, points made worse, and its distribution."""

from opml.figures import errors, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    evaluation = read_table(snakemake.input[0], "evaluation")
    component = snakemake.params.settings["component"]
    figures = [
        errors.individual_reduced(evaluation, component=component),
        errors.individual_increased(evaluation, component=component),
        errors.individual_distribution(evaluation),
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
