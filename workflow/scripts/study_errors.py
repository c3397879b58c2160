"""Draw the size of the errors before and after correction, one panel per model."""

from opml.base.section import JobSettings
from opml.figures import own_study, style
from opml.figures.axis_labels import describe_experiment, lines
from opml.naming import Experiment
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    experiment: Experiment
    learners: list[str]
    weather: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    figure = own_study.errors(
        read_by_key(settings.learners, snakemake.input, "evaluation"),
        component=settings.experiment.component,
        note=lines(describe_experiment(settings.experiment), settings.weather),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
