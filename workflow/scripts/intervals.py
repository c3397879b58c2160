"""Predict errors with intervals that hold for unseen estimates."""

from functools import partial

from opml.jobs import job
from opml.learning import dataset, intervals, learners, splits
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    table, learned = (
        dataset.read(files.dataset, files.beside),
        dataset.read(files.target, files.beside_target),
    )
    target = dataset.read(files.judge, files.beside_target) if files.judge else learned
    of, split = settings["experiment"], {key: settings[key] for key in ("span_days", "seed")}
    own = settings["train"] if of["target"] == of["rso"] else None
    found = intervals.apply(
        partial(
            learners.train, component=of["component"], settings=settings["learner"], seed=settings["seed"]
        ),
        table[splits.training_rows(table, settings["train"], **split)],
        target[splits.rows_tested(target, of["test"], train=own, learned=learned, **split)],
        component=of["component"],
        seed=settings["seed"],
        **settings["intervals"],
    )
    write_table(snakemake.output.intervals, found, "intervals", metadata=metadata)
    summary = intervals.summary(found, level=settings["intervals"]["level"], **of)
    write_table(snakemake.output.coverage, summary, "coverage", metadata=metadata)
