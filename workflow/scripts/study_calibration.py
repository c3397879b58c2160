"""Draw nominal against achieved coverage of intervals and of ellipsoids, one panel per model."""

from opml.figures import reliability, style
from opml.figures.display_names import display_learner
from opml.learning.data.error_components import CORRECTED
from opml.learning.judge import calibration
from opml.learning.judge.model_choice import CHOSEN
from opml.tables import ELLIPSOID
from opml.workflow.jobs import job
from opml.workflow.replayed_mornings import ReplayedSettings, read_mornings

with job(snakemake):
    settings, files = ReplayedSettings(**snakemake.params.settings), snakemake.input
    mornings = read_mornings(files, settings)
    every = {display_learner(name): table for name, table in mornings.tables.items()}
    tables = calibration.of_replays({CHOSEN: mornings.selected, **every}, days=settings.days)
    figures = [
        reliability.coverage_curves(tables, quantity=quantity, note=settings.note)
        for quantity in (CORRECTED, ELLIPSOID)
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
