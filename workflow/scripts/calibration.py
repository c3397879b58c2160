"""Hold the stated uncertainty of corrected positions against what was left of their errors."""

from opml import naming
from opml.constants import DAY
from opml.jobs import job
from opml.learning import calibration, dataset, learners, paths, splits
from opml.learning.uncertainty import Uncertainty
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    of, train = settings["experiment"], settings["train"]
    learned = dataset.read(files.target, files.beside)
    table = dataset.read(files.judge, files.beside) if files.judge else learned
    rows = splits.rows_tested(
        table,
        of["test"],
        train=train if of["target"] == of["rso"] else None,
        span_days=settings["span_days"],
        seed=settings["seed"],
        learned=learned,
    )
    tested = paths.with_paths(table[rows], read_table(files.predictions, "predictions"))
    found = calibration.of_residuals(
        Uncertainty.from_table(read_table(files.uncertainty, "uncertainty")),
        paths.left(learners.read(files.model), tested),
        tested["duration"].to_numpy(),
        tested["t_j"].to_numpy() - naming.parse_train(train).days[1] * DAY,
        days=calibration.marks(settings["max_days"]),
    )
    write_table(snakemake.output[0], found.assign(**of), "calibration", metadata=metadata)
