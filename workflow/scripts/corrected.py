"""Make corrected ephemerides on a regular grid ahead of estimates."""

from opml.base.constants import DAY
from opml.ephemerides import corrected
from opml.ephemerides.ephemeris_task import Task, TaskSettings
from opml.learning.data import dataset
from opml.learning.models.daily_training import DailyLearner
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress


class Settings(TaskSettings):
    seed: int
    train_days: tuple[float, float]


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    task = Task.read(files, settings, threads=snakemake.threads, progress=progress)
    (learner,) = settings.learners
    labelled = task.known.marked(dataset.read(files.dataset, files.others))
    replay = read_table(files.replay, "replay")
    table = corrected.build(
        task,
        DailyLearner(labelled, learner, settings.seed, settings.train_days[0]),
        replay,
        spreads=corrected.spreading(files, settings, task.known, threads=snakemake.threads),
        now=DAY * settings.known_until_days,
    )
    metadata |= {"covariance": corrected.basis(replay, DAY * settings.known_until_days)}
    write_table(snakemake.output[0], table, "corrected", metadata=metadata)
