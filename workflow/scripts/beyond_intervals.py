"""Draw true and corrected errors in their prediction intervals."""

from opml.base.section import JobSettings
from opml.figures import beyond, style
from opml.figures.axis_labels import describe_experiment
from opml.naming import Experiment
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    experiment: Experiment
    learners: list[str]
    level: float


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    figure = beyond.intervals(
        read_by_key(settings.learners, snakemake.input, "intervals"),
        level=settings.level,
        component=settings.experiment.component,
        note=describe_experiment(settings.experiment),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
