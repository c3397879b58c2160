"""Draw sizes of errors by duration: uncorrected, corrected by what the past chose, by each model."""

from opml.figures import own_study, style
from opml.learning.judge.model_choice import Mornings
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    replays = read_by_key(settings.learners, snakemake.input, "replay")
    figure = own_study.residuals(
        Mornings.from_replays(replays, settings.laws, seed=settings.seed),
        laws=settings.laws,
        note=settings.note,
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
