"""Put models against splits."""

from opml.jobs import job
from opml.learning import dataset, metrics, splits
from opml.report import document, generalisation
from opml.study.experiments import read_study
from opml.study.honest import Honest
from opml.study.paper import Paper
from opml.tables import read_tables

with job(snakemake):
    files, output = snakemake.input, snakemake.output
    honest = Honest(Paper(read_study(snakemake.params.settings)))
    study, test = honest.study, honest.entry["budget"]["split"][1]
    floors = {}
    for stations, path, oracle in zip(
        honest.entry["station_sets"], files.datasets, files.oracles, strict=True
    ):
        table = dataset.read(path, [oracle])
        rows = splits.test_rows(table, test, span_days=study.span_days, trained=None)
        floors[stations] = metrics.floor_share(table, rows, component=study.defaults["component"])
    blocks = generalisation.document(
        honest.generalisation,
        read_tables(files.metrics, "metrics"),
        read_tables(files.coverage, "coverage"),
        floors,
    )
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
