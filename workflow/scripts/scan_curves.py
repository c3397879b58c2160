"""Draw what combinations of readings give, beside the paper's numbers."""

from opml.figures import scan, style
from opml.jobs import job
from opml.report.scan import outcomes
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.study.scan import scan as asked
from opml.tables import read_tables

with job(snakemake):
    scanned = asked(Paper(read_study(snakemake.params.settings)))
    found = outcomes(scanned, read_tables(snakemake.input, "metrics"))
    figure = scan.scan(
        {str(one.combination): one.numbers for one in found},
        scanned.published,
        default=str(scanned.combinations[0]),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
