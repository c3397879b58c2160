"""Draw the errors of one corrected ephemeris against the estimates of later tracks."""

from opml.ephemerides.corrected import held_against
from opml.figures import later_errors, style
from opml.tables import read_table
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    table = read_table(snakemake.input.corrected, "corrected")
    first = table[table["i"] == table["i"].min()]
    errors = held_against(first, read_table(snakemake.input.estimates, "estimates"))
    settings = FigureSettings(snakemake.params.settings)
    note = "{rso} by {stations}; corrected by {learner} trained on {train}".format(**settings.values)
    figure = later_errors.later_errors(errors, level=settings.level, note=note)
    style.save_all([figure], [snakemake.output.pdf], [snakemake.output.png])
