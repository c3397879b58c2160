"""Train a learner on one error component, with variables standardised over a test's rows, too."""

from opml.learning.data import job_rows
from opml.learning.data.job_rows import RowsSettings
from opml.learning.models import learners
from opml.learning.models.learners import JobLearner
from opml.readings import joint_standardisation
from opml.tables import write_table
from opml.workflow.jobs import job


class Settings(RowsSettings):
    learner: JobLearner


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    component = settings.experiment["component"]
    rows, test = job_rows.read_with_training(snakemake.input, settings)
    model = joint_standardisation.train_jointly(
        rows, test, component=component, settings=settings.learner, seed=settings.seed
    )
    weights, described = model.to_table()
    metadata |= described | {"component": component}
    write_table(snakemake.output[0], weights, learners.schema(described), metadata=metadata)
