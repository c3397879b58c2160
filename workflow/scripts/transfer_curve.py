"""Draw P_ML on other RSOs against what sets them apart."""

from opml.figures import p_ml_curves, style
from opml.learning.judge.metrics import by_seed
from opml.tables import read_tables
from opml.workflow.jobs import job

DRAW = {
    "inclination": (p_ml_curves.inclination_curve, "inclinations"),
    "semi_major_axis": (p_ml_curves.semi_major_axis_curve, "offsets"),
}

with job(snakemake):
    settings = snakemake.params.settings
    published = {
        test: {float(value): p_ml for value, p_ml in points.items()}
        for test, points in settings["published"].items()
    }
    draw, varied = DRAW[settings["curve"]]
    figure = draw(
        by_seed(read_tables(snakemake.input, "metrics")),
        component=settings["component"],
        published=published,
        **{varied: settings["targets"]},
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
