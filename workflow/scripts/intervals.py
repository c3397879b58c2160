"""Predict errors with intervals that hold for unseen estimates."""

from functools import partial

from opml.learning.data import job_rows
from opml.learning.judge import intervals
from opml.learning.models import learners
from opml.tables import write_table
from opml.workflow.jobs import job

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    of, seed = settings["experiment"], settings["seed"]
    training, test = job_rows.read_with_training(files, settings)
    found = intervals.apply(
        partial(learners.train, component=of["component"], settings=settings["learner"], seed=seed),
        training,
        test,
        component=of["component"],
        seed=seed,
        **settings["intervals"],
    )
    write_table(snakemake.output.intervals, found, "intervals", metadata=metadata)
    summary = intervals.summary(found, level=settings["intervals"]["level"], **of)
    write_table(snakemake.output.coverage, summary, "coverage", metadata=metadata)
