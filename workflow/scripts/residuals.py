"""Measure what a correction leaves, on estimates that were not learned from."""

from functools import partial

from opml.jobs import job
from opml.learning import dataset, learners, residuals, splits
from opml.learning.paths import CORRECTED
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    table = dataset.read(files.dataset, files.beside)
    rows = splits.training_rows(
        table, settings["train"], span_days=settings["span_days"], seed=settings["seed"]
    )
    options = {"component": CORRECTED, "settings": settings["learner"], "seed": settings["seed"]}
    found = residuals.build(
        partial(learners.train, **options), table[rows], seed=settings["seed"], **settings["intervals"]
    )
    write_table(snakemake.output[0], found, "residuals", metadata=metadata)
