"""Score what correctors leave of SGP4's errors, by test, learner, band of height and lead."""

import pandas as pd

from opml.base.section import JobSettings
from opml.element_sets import corrector_scores
from opml.tables import write_table
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    trials: list[tuple[str, str]]
    seed: int


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    tables = read_by_key(map(tuple, settings.trials), snakemake.input, "catalogue_residuals")
    scores = pd.concat(
        [
            corrector_scores.scores(table, seed=settings.seed).assign(test=test, learner=learner)
            for (test, learner), table in tables.items()
        ]
    )
    write_table(snakemake.output[0], scores, "catalogue_scores", metadata=metadata)
