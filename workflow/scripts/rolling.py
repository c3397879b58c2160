"""Train a learner anew at intervals, and correct what is predicted next."""

from functools import partial

from opml.jobs import job
from opml.learning import dataset, learners, rolling
from opml.tables import write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    learned = dataset.read(files.dataset, files.beside)
    table = rolling.roll(
        partial(
            learners.train,
            component=settings["component"],
            settings=settings["learner"],
            seed=settings["seed"],
        ),
        learned,
        dataset.read(files.judge, files.beside) if files.judge else learned,
        rolling.Rolling(**settings["rolling"]),
        component=settings["component"],
    )
    write_table(snakemake.output[0], table, "rolling", metadata=metadata)
