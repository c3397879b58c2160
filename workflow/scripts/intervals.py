"""Predict errors with intervals that hold for unseen estimates."""

from functools import partial

from opml.jobs import job
from opml.learning import dataset, intervals, learners, splits, tested
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    of, seed = settings["experiment"], settings["seed"]
    table = dataset.read(files.dataset, files.beside)
    training = splits.training_rows(table, settings["train"], span_days=settings["span_days"], seed=seed)
    target, rows, _ = tested.read(files, settings, beside=files.beside_target)
    found = intervals.apply(
        partial(learners.train, component=of["component"], settings=settings["learner"], seed=seed),
        table[training],
        target[rows],
        component=of["component"],
        seed=seed,
        **settings["intervals"],
    )
    write_table(snakemake.output.intervals, found, "intervals", metadata=metadata)
    summary = intervals.summary(found, level=settings["intervals"]["level"], **of)
    write_table(snakemake.output.coverage, summary, "coverage", metadata=metadata)
