"""Write a page to turn the orbit and pick an estimate."""

from opml.base.files import replacing
from opml.figures import explore
from opml.figures.axis_labels import describe_experiment
from opml.figures.ground import ObservedOrbit
from opml.orbits.sheets import Station
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    settings, files = FigureSettings(snakemake.params.settings), snakemake.input
    orbit = ObservedOrbit(
        read_table(files.truth, "truth"),
        read_table(files.earth_orientation, "earth_orientation"),
        [Station(**station) for station in settings.radars],
    )
    text = explore.page(
        orbit,
        read_by_key(settings.learners, files.evaluations, "evaluation"),
        read_table(files.dataset, "dataset"),
        component=settings.component,
        epoch=settings.epoch,
        note=describe_experiment(settings.values),
    )
    with replacing(snakemake.output[0]) as temporary:
        temporary.write_text(text, encoding="utf-8")
