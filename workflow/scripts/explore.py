"""Write the page on which one turns the orbit and picks an estimate."""

from opml.base.files import replacing
from opml.figures import explore
from opml.figures.axis_labels import experiment
from opml.orbits.sheets import Station
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    evaluations = {
        name: read_table(path, "evaluation")
        for name, path in zip(settings["learners"], files.evaluations, strict=True)
    }
    text = explore.page(
        evaluations,
        read_table(files.dataset, "dataset"),
        read_table(files.truth, "truth"),
        read_table(files.earth_orientation, "earth_orientation"),
        [Station(**one) for one in settings["radars"]],
        component=settings["component"],
        note=experiment(**settings),
    )
    with replacing(snakemake.output[0]) as temporary:
        temporary.write_text(text, encoding="utf-8")
