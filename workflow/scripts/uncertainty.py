"""Learn from the past how far corrected positions may be off."""

from functools import partial

from opml.jobs import job
from opml.learning import dataset, learners, splits, uncertainty
from opml.learning.paths import CORRECTED, with_paths
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    table = dataset.read(files.dataset, files.beside)
    rows = splits.training_rows(
        table, settings["train"], span_days=settings["span_days"], seed=settings["seed"]
    )
    rolled = uncertainty.roll(
        partial(learners.train, component=CORRECTED, settings=settings["learner"], seed=settings["seed"]),
        with_paths(table[rows], read_table(files.predictions, "predictions")),
        at=settings["origins"],
    )
    found = uncertainty.calibrate(rolled, **settings["uncertainty"])
    write_table(snakemake.output[0], found.to_table(), "uncertainty", metadata=metadata)
