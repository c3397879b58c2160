"""Put models against splits."""

from opml.jobs import job
from opml.learning import dataset, metrics, splits
from opml.report import document, generalisation
from opml.sheets import read_rsos
from opml.tables import read_tables

with job(snakemake):
    settings, files, output = snakemake.params.settings, snakemake.input, snakemake.output
    entry, span_days = settings["experiments"]["generalisation"], settings["learning"]["span_days"]
    component, test = settings["experiments"]["defaults"]["component"], entry["budget"]["split"][1]
    floors = {}
    for stations, path, oracle in zip(entry["station_sets"], files.datasets, files.oracles, strict=True):
        table = dataset.read(path, [oracle])
        rows = splits.test_rows(table, test, span_days=span_days, trained=None)
        floors[stations] = metrics.floor_share(table, rows, component=component)
    blocks = generalisation.document(
        settings,
        read_tables(files.metrics, "metrics"),
        read_tables(files.coverage, "coverage"),
        floors,
        read_rsos(settings["sheets"]["rsos"]),
    )
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
