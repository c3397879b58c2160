"""Write the paper's tables of models, stations and RSOs, from the settings that ran."""

from opml.jobs import job
from opml.report import document, settings
from opml.sheets import Rso, Station

with job(snakemake):
    given = snakemake.params.settings
    documents = [
        settings.models(given),
        settings.stations([Station(**station) for station in given["stations"]]),
        settings.rsos([Rso(**given["rso"])], epoch=given["epoch"], title="Simulated RSO"),
        settings.rsos([Rso(**rso) for rso in given["rsos"]], epoch=given["epoch"], title="Other RSOs"),
    ]
    output = snakemake.output
    for blocks, *paths in zip(documents, output.md, output.tsv, output.html, strict=True):
        document.write(blocks, *paths)
