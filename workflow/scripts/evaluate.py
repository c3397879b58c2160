"""Apply a trained model to a test split and measure P_ML."""

import math

from opml.jobs import job
from opml.learning import learners, metrics, tested
from opml.learning.evaluation import as_tested, evaluate
from opml.tables import read_metadata, write_table

with job(snakemake) as metadata:
    settings, files, output = snakemake.params.settings, snakemake.input, snakemake.output
    experiment = settings["experiment"]
    table, rows, learned = tested.read(files, settings, beside=files.beside)
    model = as_tested(learners.read(files.model), experiment["test"])
    corrected = evaluate(model, table, rows, component=experiment["component"])
    write_table(output.evaluation, corrected, "evaluation", metadata=metadata)
    summary = metrics.summary(
        corrected,
        seed_noise=settings["noise"],
        seed_split=settings["seed"],
        p_ml_later=metrics.against_labels(corrected, learned, component=experiment["component"]),
        kernel_scale=read_metadata(files.model).get("kernel_scale", math.nan),
        **experiment,
    )
    write_table(output.metrics, summary, "metrics", metadata=metadata)
