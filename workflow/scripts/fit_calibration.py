"""Hold the fits' own covariances, carried to the predictions, against the predictions' errors."""

from opml.jobs import job
from opml.learning import calibration, dataset, splits
from opml.learning.paths import POSITION
from opml.tables import POSITION_COVARIANCES, symmetric, write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    of = settings["experiment"]
    learned = dataset.read(files.target, [files.covariances])
    table = dataset.read(files.judge, [files.covariances]) if files.judge else learned
    rows = splits.rows_tested(
        table,
        of["test"],
        train=settings["train"] if of["target"] == of["rso"] else None,
        span_days=settings["span_days"],
        seed=settings["seed"],
        learned=learned,
    )
    found = calibration.of_fits(
        symmetric(table[rows], POSITION_COVARIANCES),
        table.loc[rows, POSITION].to_numpy(),
        table.loc[rows, "duration"].to_numpy(),
        days=calibration.marks(settings["max_days"]),
    )
    write_table(snakemake.output[0], found.assign(**settings["experiment"]), "calibration", metadata=metadata)
