"""Report models against splits."""

from opml.report import beyond as report
from opml.report import document
from opml.study.beyond import Beyond
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.tables import read_tables
from opml.workflow.jobs import job

with job(snakemake):
    output = snakemake.output
    beyond = Beyond(Paper(read_study(snakemake.params.settings)))
    blocks = report.document(beyond.report, read_tables(snakemake.input.metrics, "metrics"))
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
