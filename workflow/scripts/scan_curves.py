"""Draw what combinations of readings give, beside the paper's numbers."""

from opml.figures import style
from opml.readings import scan_figure
from opml.readings.scan import scan as asked
from opml.readings.scan_report import outcomes
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.tables import read_tables
from opml.workflow.jobs import job

with job(snakemake):
    scanned = asked(Paper(read_study(snakemake.params.settings)))
    found = outcomes(scanned, read_tables(snakemake.input, "metrics"))
    figure = scan_figure.scan(
        {str(one.combination): one.numbers for one in found},
        scanned.published,
        default=str(scanned.combinations[0]),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
