"""Score what correctors leave of SGP4's errors, by test, learner, band of height and lead."""

import pandas as pd

from opml.element_sets import judge
from opml.tables import write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake) as metadata:
    settings = JobSettings(snakemake.params.settings)
    tables = read_by_key(map(tuple, settings.trials), snakemake.input, "catalogue_residuals")
    scores = pd.concat(
        [
            judge.scores(table, seed=settings.seed).assign(test=test, learner=learner)
            for (test, learner), table in tables.items()
        ]
    )
    write_table(snakemake.output[0], scores, "catalogue_scores", metadata=metadata)
