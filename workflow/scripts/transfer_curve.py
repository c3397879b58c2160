"""Draw P_ML on other RSOs against the element that they differ in."""

from opml.base.section import JobSettings
from opml.figures import p_ml_curves, style
from opml.tables import read_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    published: dict[str, dict[str, float]]
    curve: str
    targets: dict[str, float]
    component: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    published = {
        test: {float(value): p_ml for value, p_ml in points.items()}
        for test, points in settings.published.items()
    }
    figure = p_ml_curves.transfer_curve(
        read_tables(snakemake.input, "metrics"),
        settings.curve,
        settings.targets,
        component=settings.component,
        published=published,
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
