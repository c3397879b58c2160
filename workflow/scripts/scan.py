"""Hold combinations of readings against the paper's numbers and sentences."""

from opml.jobs import job
from opml.report import document, scan
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.study.scan import scan as asked
from opml.tables import read_tables

with job(snakemake):
    output = snakemake.output
    paper = Paper(read_study(snakemake.params.settings))
    blocks = scan.document(asked(paper), read_tables(snakemake.input, "metrics"))
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
