"""Train a learner on one error component."""

from opml.base.section import JobSettings
from opml.learning.data import dataset, splits
from opml.learning.models import learners
from opml.learning.models.learners import JobLearner
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    train: str
    span_days: tuple[float, float]
    seed: int
    component: str
    learner: JobLearner


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    table = dataset.read(snakemake.input.dataset, snakemake.input.others)
    rows = splits.training_rows(table, settings.train, span_days=settings.span_days, seed=settings.seed)
    model = learners.train(
        table[rows], component=settings.component, settings=settings.learner, seed=settings.seed
    )
    weights, described = model.to_table()
    metadata |= described | {"component": settings.component}
    write_table(snakemake.output[0], weights, learners.schema(described), metadata=metadata)
