"""Draw mean and spread of the absolute errors of several RSOs side by side."""

from opml.figures import notes, prediction_errors, style
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
    common = {"rso": "each RSO", "target": "each RSO", "cleaning": settings.cleaning}
    evaluations, contexts = {}, {}
    tables = zip(files.evaluation, files.metrics, files.dataset, strict=True)
    for names, (evaluation, metrics, dataset) in zip(settings.experiments, tables, strict=True):
        evaluations[names["target"]] = read_table(evaluation, "evaluation")
        contexts[names["target"]] = notes.read_context(names | common, metrics, dataset)
    figure = prediction_errors.rso_grid(evaluations, component=settings.component, contexts=contexts)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
