"""Report a study: errors in metres, skill, models against splits, rows used."""

from opml.catalog.fit.biases import read_noise
from opml.report import document, own_study
from opml.study.experiments import Study
from opml.study.own_study import OwnStudy
from opml.study.settings.merging import with_sheets
from opml.tables import read_tables
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    files, output = snakemake.input, snakemake.output
    study = OwnStudy(Study(with_sheets(snakemake.params.settings)))
    tables = own_study.OwnStudyTables(
        metrics=read_tables(files.metrics, "metrics"),
        evaluations=read_by_key(study.stated, files.evaluations, "evaluation"),
        datasets=read_by_key(study.datasets, files.datasets, "dataset"),
        estimates=read_by_key(study.datasets, files.estimates, "estimates"),
        noise=dict(zip(study.datasets, map(read_noise, files.estimates), strict=True)),
    )
    blocks = own_study.document(study.report, tables)
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
