"""Draw nominal against achieved coverage of intervals and of ellipsoids, one panel per model."""

from opml.figures import reliability as figures
from opml.figures import style
from opml.learning.data.components import CORRECTED
from opml.learning.judge import calibration
from opml.learning.judge.model_choice import Mornings
from opml.tables import ELLIPSOID, read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    replays = {
        name: read_table(path, "replay")
        for name, path in zip(settings["learners"], files.replays, strict=True)
    }
    mornings = Mornings.from_replays(replays, settings["laws"], seed=settings["seed"])
    models = {"chosen by the past": mornings.flown, **mornings.tables}
    tables = calibration.of_replays(models, days=settings["days"])
    tables["the fit's own covariance"] = read_table(files.fit, "calibration")
    drawn = [
        figures.coverage(tables, quantity=quantity, note=settings["note"])
        for quantity in (CORRECTED, ELLIPSOID)
    ]
    style.save_all(drawn, snakemake.output.pdf, snakemake.output.png)
