"""Tabulate P_ML of all six components."""

from opml.report import document, settings_tables
from opml.tables import COMPONENTS, read_tables
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    names = FigureSettings(snakemake.params.settings).evaluations
    p_ml = read_tables(snakemake.input, "metrics")["p_ml"].to_numpy().reshape(len(names), len(COMPONENTS))
    output = snakemake.output
    document.write(
        settings_tables.components(dict(zip(names, p_ml, strict=True))),
        output.md[0],
        output.tsv[0],
        output.html[0],
    )
