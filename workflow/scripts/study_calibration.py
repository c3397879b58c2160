"""Draw nominal against achieved coverage of intervals and of ellipsoids, one panel per model."""

from opml.figures import calibration, style
from opml.figures.labels import experiment
from opml.jobs import job
from opml.learning.calibration import ELLIPSOID
from opml.learning.paths import CORRECTED
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    names = ["the fit's own covariance", *settings["models"]]
    tables = {
        name: read_table(path, "calibration") for name, path in zip(names, snakemake.input, strict=True)
    }
    figures = [
        calibration.coverage(tables, quantity=quantity, note=experiment(**settings))
        for quantity in (CORRECTED, ELLIPSOID)
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
