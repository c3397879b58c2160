"""Draw P_ML of combinations of readings, beside the paper's numbers."""

from opml.figures import style
from opml.readings import scan, scan_figure
from opml.readings.scan_report import outcomes
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.tables import read_tables
from opml.workflow.jobs import job

with job(snakemake):
    scanned = scan.scan(Paper(read_study(snakemake.params.settings)))
    nearest_first = outcomes(scanned, read_tables(snakemake.input, "metrics"))
    figure = scan_figure.scan_dots(
        {str(outcome.combination): outcome.numbers for outcome in nearest_first},
        scanned.published,
        {name: experiment for name, (experiment, _) in scanned.numbers.items()},
        default=str(scanned.combinations[0]),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
