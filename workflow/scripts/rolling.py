"""Train a learner anew at intervals, and correct what is predicted next."""

from functools import partial

from opml.base.section import JobSettings
from opml.learning.data import dataset
from opml.learning.judge import rolling_origins
from opml.learning.judge.rolling_origins import Rolling
from opml.learning.models import learners
from opml.learning.models.learners import JobLearner
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    component: str
    learner: JobLearner
    seed: int
    rolling: Rolling


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    learned = dataset.read(files.dataset, files.beside)
    table = rolling_origins.roll(
        partial(
            learners.train,
            component=settings.component,
            settings=settings.learner,
            seed=settings.seed,
        ),
        learned,
        dataset.read(files.judge, files.beside) if files.judge else learned,
        settings.rolling,
        component=settings.component,
    )
    write_table(snakemake.output[0], table, "rolling", metadata=metadata)
