"""Draw mean and spread of the absolute errors of several RSOs side by side."""

from opml.figures import notes, prediction_errors, style
from opml.learning.data.cleaning import Cleaning
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    cleaning, evaluations, contexts = Cleaning.from_settings(settings["cleaning"]), {}, {}
    tables = zip(files.evaluation, files.metrics, files.dataset, strict=True)
    for names, (evaluation, metrics, dataset) in zip(settings["experiments"], tables, strict=True):
        rso = names["target"]
        evaluations[rso] = read_table(evaluation, "evaluation")
        contexts[rso] = notes.experiment_context(
            names | {"rso": "each RSO", "target": "each RSO"},
            read_table(metrics, "metrics"),
            read_table(dataset, "dataset"),
            cleaning,
        )
    figure = prediction_errors.rso_grid(evaluations, component=settings["component"], contexts=contexts)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
