"""Draw the individual performance metric: predictions made better, those made worse, and its distribution."""

from opml.figures import prediction_errors, style
from opml.figures.axis_labels import describe_experiment
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    evaluation = read_table(snakemake.input[0], "evaluation")
    component, note = settings.component, describe_experiment(settings.values)
    figures = [
        prediction_errors.individual_reduced(evaluation, component=component, note=note),
        prediction_errors.individual_increased(evaluation, component=component, note=note),
        prediction_errors.individual_distribution(evaluation, published=settings.published, note=note),
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
