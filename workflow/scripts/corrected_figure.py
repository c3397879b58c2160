"""Draw the errors of one corrected ephemeris against the estimates of later tracks."""

from opml.base.section import JobSettings
from opml.ephemerides.corrected import errors_at_estimates
from opml.figures import errors_at_later_tracks, style
from opml.figures.axis_labels import describe_training
from opml.figures.display_names import describe_run, display_learner
from opml.learning.judge.error_sizes import LEVEL
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    stations: str
    learner: str
    train: str


with job(snakemake):
    table = read_table(snakemake.input.corrected, "corrected")
    first = table[table["i"] == table["i"].min()]
    errors = errors_at_estimates(first, read_table(snakemake.input.estimates, "estimates"))
    settings = Settings(**snakemake.params.settings)
    learner, training = display_learner(settings.learner), describe_training(settings.train)
    note = f"{describe_run(settings.rso, settings.stations)}; corrected by {learner} trained on {training}"
    figure = errors_at_later_tracks.later_errors(errors, level=LEVEL, note=note)
    style.save_all([figure], [snakemake.output.pdf], [snakemake.output.png])
