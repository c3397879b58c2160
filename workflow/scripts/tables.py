"""Write the paper's tables of models, stations and RSOs, from the settings that ran."""

from opml.orbits.sheets import Rso, Station
from opml.report import document, settings_tables
from opml.workflow.jobs import job

with job(snakemake):
    given = snakemake.params.settings
    documents = [
        settings_tables.models(given),
        settings_tables.stations([Station(**station) for station in given["stations"]]),
        settings_tables.rsos([Rso(**given["rso"])], epoch=given["epoch"], title="Simulated RSO"),
        settings_tables.rsos([Rso(**rso) for rso in given["rsos"]], epoch=given["epoch"], title="Other RSOs"),
    ]
    output = snakemake.output
    for blocks, *paths in zip(documents, output.md, output.tsv, output.html, strict=True):
        document.write(blocks, *paths)
