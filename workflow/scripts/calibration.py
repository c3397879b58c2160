"""Hold the stated uncertainty of corrected positions against what was left of their errors."""

from opml import naming
from opml.constants import DAY
from opml.jobs import job
from opml.learning import calibration, learners, paths, tested
from opml.learning.uncertainty import Uncertainty
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    trained_until = naming.parse_train(settings["train"]).days[1] * DAY
    table, rows, _ = tested.read(files, settings, beside=files.beside)
    known = paths.with_paths(table[rows], read_table(files.predictions, "predictions"))
    found = calibration.of_residuals(
        Uncertainty.from_table(read_table(files.uncertainty, "uncertainty")),
        paths.left(learners.read(files.model), known),
        known["duration"].to_numpy(),
        known["t_j"].to_numpy() - trained_until,
        days=calibration.marks(settings["max_days"]),
    )
    write_table(snakemake.output[0], found.assign(**settings["experiment"]), "calibration", metadata=metadata)
