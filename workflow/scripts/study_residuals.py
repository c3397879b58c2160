"""Draw sizes of errors by duration: uncorrected, corrected by what the past chose, by each model."""

from opml.figures import study, style
from opml.jobs import job
from opml.learning.choice import Mornings
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    replays = {
        name: read_table(path, "replay")
        for name, path in zip(settings["learners"], snakemake.input, strict=True)
    }
    figure = study.residuals(
        Mornings.of(replays, settings["laws"], seed=settings["seed"]),
        laws=settings["laws"],
        note=settings["note"],
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
