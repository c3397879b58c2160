"""Answer a study: models against splits, errors in metres, rows used."""

from opml.report import document, own_study
from opml.study.experiments import read_study
from opml.study.own_study import Own
from opml.tables import read_table, read_tables
from opml.workflow.jobs import job

with job(snakemake):
    files, output = snakemake.input, snakemake.output
    own = Own(read_study(snakemake.params.settings))
    stated = zip(own.stated, files.evaluations, strict=True)
    blocks = own_study.document(
        own.answer,
        read_tables(files.metrics, "metrics"),
        {key: read_table(path, "evaluation") for key, path in stated},
        {key: read_table(path, "dataset") for key, path in zip(own.datasets, files.datasets, strict=True)},
        {key: read_table(path, "estimates") for key, path in zip(own.datasets, files.estimates, strict=True)},
        {key: read_table(path, "rolling") for key, path in zip(own.rolling, files.rolling, strict=True)},
        {key: read_table(path, "replay") for key, path in zip(own.replayed, files.replays, strict=True)},
        {key: read_table(path, "calibration") for key, path in zip(own.fits, files.fits, strict=True)},
    )
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
