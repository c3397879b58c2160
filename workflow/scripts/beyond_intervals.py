"""Draw true and corrected errors in their prediction intervals."""

from opml.figures import beyond, style
from opml.figures.axis_labels import describe_experiment
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    figure = beyond.intervals(
        read_by_key(settings.learners, snakemake.input, "intervals"),
        level=settings.level,
        component=settings.component,
        note=describe_experiment(settings.values),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
