"""Draw P_ML by day of learners that are trained anew, beside the same ones trained once."""

from opml.figures import own_study, style
from opml.figures.axis_labels import with_weather
from opml.learning.judge.rolling_origins import by_day
from opml.tables import read_table
from opml.workflow.jobs import job

with job(snakemake):
    settings = snakemake.params.settings
    files = zip(settings["learners"], snakemake.input, strict=True)
    days = {learner: by_day(read_table(path, "rolling")) for learner, path in files}
    note = (
        f"{settings['rso']} by {settings['stations']}, {settings['last_days']:g} days to learn from at most"
    )
    figure = own_study.rolling(days, every_days=settings["every_days"], note=with_weather(note, settings))
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
