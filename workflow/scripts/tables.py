"""Write the paper's tables of models, stations and RSOs, from the settings that ran."""

from opml.base.section import JobSettings
from opml.dynamics.settings import ForceModels
from opml.environment.settings import EnvironmentSettings
from opml.orbits.sheets import Rso, Station
from opml.report import document, settings_tables
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    environment: EnvironmentSettings
    force_models: ForceModels
    rsos: list[Rso]
    stations: list[Station]
    rso: Rso


with job(snakemake):
    settings, output = Settings(**snakemake.params.settings), snakemake.output
    documents = [
        settings_tables.models(settings.environment, settings.force_models),
        settings_tables.stations(settings.stations),
        settings_tables.rsos([settings.rso], epoch=settings.epoch, title="Simulated RSO"),
        settings_tables.rsos(settings.rsos, epoch=settings.epoch, title="Other RSOs"),
    ]
    for blocks, *paths in zip(documents, output.md, output.tsv, output.html, strict=True):
        document.write(blocks, *paths)
