"""Apply a trained model to a test split and measure P_ML."""

import math

from opml.learning.data import job_rows
from opml.learning.data.job_rows import RowsSettings
from opml.learning.judge import metrics
from opml.learning.judge.evaluation import evaluate
from opml.learning.models import learners
from opml.tables import read_metadata, write_table
from opml.workflow.jobs import job


class Settings(RowsSettings):
    noise: int


with job(snakemake) as metadata:
    settings, files, output = Settings(**snakemake.params.settings), snakemake.input, snakemake.output
    experiment = settings.experiment
    table, rows, learned = job_rows.read(files, settings, others=files.others)
    model = learners.read(files.model)
    corrected = evaluate(model, table, rows, component=experiment["component"])
    write_table(output.evaluation, corrected, "evaluation", metadata=metadata)
    summary = metrics.summary(
        corrected,
        seed_noise=settings.noise,
        seed_split=settings.seed,
        p_ml_later=metrics.against_labels(corrected, learned, component=experiment["component"]),
        kernel_scale=read_metadata(files.model).get("kernel_scale", math.nan),
        **experiment,
    )
    write_table(output.metrics, summary, "metrics", metadata=metadata)
