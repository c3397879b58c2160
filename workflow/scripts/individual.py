"""Draw the individual performance metric: predictions made better, those made worse, and its distribution."""

from opml.base.section import JobSettings
from opml.figures import prediction_errors, style
from opml.figures.axis_labels import describe_experiment
from opml.naming import Experiment
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    experiment: Experiment
    published: float | None


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    evaluation = read_table(snakemake.input[0], "evaluation")
    component, note = settings.experiment.component, describe_experiment(settings.experiment)
    figures = [
        prediction_errors.individual_reduced(evaluation, component=component, note=note),
        prediction_errors.individual_increased(evaluation, component=component, note=note),
        prediction_errors.individual_distribution(evaluation, published=settings.published, note=note),
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
