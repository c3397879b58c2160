"""Predict errors with intervals that hold for unseen estimates."""

from functools import partial

from opml.learning.data import job_rows
from opml.learning.data.job_rows import RowsSettings
from opml.learning.judge import intervals
from opml.learning.judge.intervals import Conformal
from opml.learning.models import learners
from opml.learning.models.learners import JobLearner
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(RowsSettings):
    learner: JobLearner
    intervals: Conformal


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    experiment, seed = settings.experiment, settings.seed
    component = experiment["component"]
    training, test = job_rows.read_with_training(files, settings)
    table = intervals.apply(
        partial(learners.train, component=component, settings=settings.learner, seed=seed),
        training,
        test,
        settings.intervals,
        component=component,
        seed=seed,
    )
    write_table(snakemake.output.intervals, table, "intervals", metadata=metadata)
    summary = intervals.coverage_summary(table, level=settings.intervals.level, **experiment)
    write_table(snakemake.output.coverage, summary, "coverage", metadata=metadata)
