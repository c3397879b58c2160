"""Draw mean and spread of the absolute errors of several RSOs side by side."""

from dataclasses import replace

from opml.base.section import JobSettings
from opml.figures import notes, prediction_errors, style
from opml.learning.data.cleaning import Cleaning
from opml.naming import Experiment
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    cleaning: Cleaning
    experiments: list[Experiment]
    component: str


with job(snakemake):
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    evaluations, contexts = {}, {}
    tables = zip(files.evaluation, files.metrics, files.dataset, strict=True)
    for experiment, (evaluation, metrics, dataset) in zip(settings.experiments, tables, strict=True):
        each = replace(experiment, rso="each RSO", target="each RSO")
        evaluations[experiment.target] = read_table(evaluation, "evaluation")
        contexts[experiment.target] = notes.read_context(each, settings.cleaning, metrics, dataset)
    figure = prediction_errors.rso_grid(evaluations, component=settings.component, contexts=contexts)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
