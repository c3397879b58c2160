"""Predict errors with intervals that hold for unseen estimates."""

from functools import partial

from opml.jobs import job
from opml.learning import intervals, learners, tested
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    of, seed = settings["experiment"], settings["seed"]
    training, test = tested.read_with_training(files, settings)
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
