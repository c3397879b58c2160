"""Draw sizes of errors by duration: uncorrected, corrected by what the past chose, by each model."""

from opml.figures import own_study, style
from opml.learning.judge.model_choice import Mornings
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings = snakemake.params.settings
    replays = {
        name: read_table(path, "replay")
        for name, path in zip(settings["learners"], snakemake.input, strict=True)
    }
    figure = own_study.residuals(
        Mornings.from_replays(replays, settings["laws"], seed=settings["seed"]),
        laws=settings["laws"],
        note=settings["note"],
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
