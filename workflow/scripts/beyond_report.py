"""Report models against splits."""

from opml.learning.data import dataset, splits
from opml.learning.judge import metrics
from opml.report import beyond as report
from opml.report import document
from opml.study.beyond import Beyond
from opml.study.experiments import read_study
from opml.study.paper import Paper
from opml.tables import read_tables
from opml.workflow.jobs import job

with job(snakemake):
    files, output = snakemake.input, snakemake.output
    beyond = Beyond(Paper(read_study(snakemake.params.settings)))
    study, test = beyond.study, beyond.entry["budget"]["split"][1]
    floors = {}
    for stations, path, oracle in zip(
        beyond.entry["station_sets"], files.datasets, files.oracles, strict=True
    ):
        table = dataset.read(path, [oracle])
        rows = splits.test_rows(table, test, span_days=study.span_days, trained=None)
        floors[stations] = metrics.floor_share(table, rows, component=study.defaults["component"])
    blocks = report.document(
        beyond.report,
        read_tables(files.metrics, "metrics"),
        read_tables(files.coverage, "coverage"),
        floors,
    )
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
