"""Report the paper's numbers beside ours."""

import pandas as pd

from opml.report import document, reproduction
from opml.study.experiments import Study
from opml.study.paper import Paper
from opml.study.settings.merging import with_sheets
from opml.tables import read_metadata, read_table, read_tables
from opml.workflow.jobs import job

with job(snakemake):
    files, output = snakemake.input, snakemake.output
    paper = Paper(Study(with_sheets(snakemake.params.settings)))
    counts = [
        reproduction.counts(
            read_table(dataset, "dataset"),
            read_table(estimates, "estimates"),
            name=f"{rso}, {stations}",
            days=paper.study.span_days,
        )
        for (rso, stations), dataset, estimates in zip(
            paper.datasets, files.datasets, files.estimates, strict=True
        )
    ]
    scales = [read_metadata(model)["kernel_scale"] for model in files.models]
    blocks = reproduction.document(
        paper.reproduction,
        read_tables(files.metrics, "metrics"),
        pd.DataFrame(counts),
        dict(zip((headline.name for headline in paper.headlines), scales, strict=True)),
    )
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
