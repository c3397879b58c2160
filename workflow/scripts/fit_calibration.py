"""Compare the covariances of the fits, carried to the predictions, with the errors of the predictions."""

from opml.learning.data import job_rows
from opml.learning.data.error_components import POSITION
from opml.learning.data.job_rows import RowsSettings
from opml.learning.judge import calibration
from opml.tables import POSITION_COVARIANCES, symmetric_matrices, write_table
from opml.workflow.jobs import job


class Settings(RowsSettings):
    max_days: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    table, rows, _ = job_rows.read(files, settings, others=[files.covariances])
    shares = calibration.of_covariances(
        symmetric_matrices(table[rows], POSITION_COVARIANCES),
        table.loc[rows, POSITION].to_numpy(),
        table.loc[rows, "duration"].to_numpy(),
        days=calibration.marks(settings.max_days),
    )
    write_table(snakemake.output[0], shares.assign(**settings.experiment), "calibration", metadata=metadata)
