"""Put the paper's numbers beside ours."""

import pandas as pd

from opml.jobs import job
from opml.report import document, reproduction
from opml.sheets import read_rsos
from opml.tables import read_metadata, read_table, read_tables

with job(snakemake):
    settings, files, output = snakemake.params.settings, snakemake.input, snakemake.output
    counts = [
        reproduction.counts(
            read_table(dataset, "dataset"),
            read_table(estimates, "estimates"),
            name=f"{rso}, {stations}",
            days=settings["learning"]["span_days"],
        )
        for (rso, stations), dataset, estimates in zip(
            settings["datasets"], files.datasets, files.estimates, strict=True
        )
    ]
    scales = [read_metadata(model)["kernel_scale"] for model in files.models]
    blocks = reproduction.document(
        settings,
        read_tables(files.metrics, "metrics"),
        pd.DataFrame(counts),
        dict(zip(settings["headlines"], scales, strict=True)),
        read_rsos(settings["sheets"]["rsos"]),
    )
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
