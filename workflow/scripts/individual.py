"""Draw the individual performance metric: points made better, points made worse, and its distribution."""

from opml.figures import errors, labels, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    evaluation = read_table(snakemake.input[0], "evaluation")
    component, note = settings["component"], labels.experiment(**settings)
    figures = [
        errors.individual_reduced(evaluation, component=component, note=note),
        errors.individual_increased(evaluation, component=component, note=note),
        errors.individual_distribution(evaluation, published=settings["published"], note=note),
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
