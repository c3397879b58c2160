"""Report combinations of readings against the paper's numbers and sentences."""

from opml.readings import scan, scan_report
from opml.report import document
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.tables import read_tables
from opml.workflow.jobs import job

with job(snakemake):
    output = snakemake.output
    paper = Paper(read_study(snakemake.params.settings))
    blocks = scan_report.document(scan.scan(paper), read_tables(snakemake.input, "metrics"))
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
