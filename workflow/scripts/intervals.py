"""Predict errors with intervals that hold for unseen estimates."""

from functools import partial

from opml.learning.data import job_rows
from opml.learning.judge import intervals
from opml.learning.models import learners
from opml.tables import write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings, files = JobSettings(snakemake.params.settings), snakemake.input
    experiment, seed = settings.experiment, settings.seed
    component = experiment["component"]
    training, test = job_rows.read_with_training(files, settings.values)
    table = intervals.apply(
        partial(learners.train, component=component, settings=settings.learner, seed=seed),
        training,
        test,
        intervals.Conformal(**settings.intervals),
        component=component,
        seed=seed,
    )
    write_table(snakemake.output.intervals, table, "intervals", metadata=metadata)
    summary = intervals.coverage_summary(table, level=settings.intervals["level"], **experiment)
    write_table(snakemake.output.coverage, summary, "coverage", metadata=metadata)
