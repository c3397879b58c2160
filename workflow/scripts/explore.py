"""Write a page to turn the orbit and pick an estimate."""

from opml.base.files import replacing
from opml.base.section import JobSettings
from opml.figures import orbit_explorer
from opml.figures.axis_labels import describe_experiment
from opml.figures.ground_tracks import ObservedOrbit
from opml.naming import Experiment
from opml.orbits.sheets import Station
from opml.tables import read_table
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    experiment: Experiment
    radars: list[Station]
    learners: list[str]
    epoch: str


with job(snakemake):
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    orbit = ObservedOrbit(
        read_table(files.truth, "truth"),
        read_table(files.earth_orientation, "earth_orientation"),
        settings.radars,
    )
    text = orbit_explorer.page(
        orbit,
        read_by_key(settings.learners, files.evaluations, "evaluation"),
        read_table(files.dataset, "dataset"),
        component=settings.experiment.component,
        epoch=settings.epoch,
        back="../../../study.html",
        note=describe_experiment(settings.experiment),
    )
    with replacing(snakemake.output[0]) as temporary:
        temporary.write_text(text, encoding="utf-8")
