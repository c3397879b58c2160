"""Draw sizes of errors by duration: uncorrected, corrected by what the past chose, by each model."""

from opml.base.section import JobSettings
from opml.figures import own_study, style
from opml.learning.judge.model_choice import Mornings
from opml.tables import read_table
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    learners: list[str]
    laws: list[str]
    seed: int
    note: str


with job(snakemake):
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    replays = read_by_key(settings.learners, files.replays, "replay")
    mornings = Mornings.from_replays(replays, settings.laws, seed=settings.seed)
    if files.judge:
        mornings = mornings.against_truth(*(read_table(path, "dataset") for path in files.judge))
    figure = own_study.residuals(mornings, laws=settings.laws, note=settings.note)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
