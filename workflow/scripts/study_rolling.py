"""Draw P_ML by day of learners that are trained anew, beside the same ones trained once."""

from opml.figures import own_study, style
from opml.figures.axis_labels import add_weather
from opml.figures.display_names import describe_run
from opml.learning.judge.rolling_origins import by_day
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job, read_by_key

with job(snakemake):
    settings = FigureSettings(snakemake.params.settings)
    tables = read_by_key(settings.learners, snakemake.input, "rolling")
    days = {learner: by_day(table) for learner, table in tables.items()}
    note = f"{describe_run(settings.values)}, {settings.last_days:g} days to learn from at most"
    figure = own_study.rolling(
        days, every_days=settings.every_days, epoch=settings.epoch, note=add_weather(note, settings.values)
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
