"""Write the paper's tables of models, stations and RSOs, from the settings that ran."""

from opml.orbits.sheets import Rso, Station
from opml.report import document, settings_tables
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, output = JobSettings(snakemake.params.settings), snakemake.output
    epoch, others = settings.epoch, [Rso(**rso) for rso in settings.rsos]
    documents = [
        settings_tables.models(settings.values),
        settings_tables.stations([Station(**station) for station in settings.stations]),
        settings_tables.rsos([Rso(**settings.rso)], epoch=epoch, title="Simulated RSO"),
        settings_tables.rsos(others, epoch=epoch, title="Other RSOs"),
    ]
    for blocks, *paths in zip(documents, output.md, output.tsv, output.html, strict=True):
        document.write(blocks, *paths)
