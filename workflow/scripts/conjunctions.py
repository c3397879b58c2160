"""Tell what the predictions of a study's mornings are worth where objects may collide."""

from opml.conjunctions import worth
from opml.learning.judge.model_choice import Mornings
from opml.tables import read_table, write_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake) as metadata:
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
    replays = read_by_key(settings.learners, files.replays, "replay")
    mornings = Mornings.from_replays(replays, settings.laws, seed=settings.seed)
    if files.judge:
        mornings = mornings.judged(*(read_table(path, "dataset") for path in files.judge))
    table = worth.compare(
        mornings,
        read_table(files.fits, "covariances"),
        worth.Screening(settings.radius_m, settings.threshold),
        laws=settings.laws,
        days=settings.days,
        seed=settings.seed,
    )
    write_table(snakemake.output[0], table, "conjunctions", metadata=metadata)
