"""Draw P_ML against the kernel scale, with the scales of the rules marked."""

from opml.figures import p_ml_curves, style
from opml.tables import read_metadata, read_tables
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    metrics = read_tables(snakemake.input.metrics, "metrics")
    rules = {}
    for (stations, rule), path in zip(settings.rules, snakemake.input.models, strict=True):
        rules.setdefault(stations, {})[rule] = read_metadata(path)["kernel_scale"]
    figure = p_ml_curves.kernel_scale_sensitivity(metrics, rules, component=settings.component)
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
