"""Draw P_ML by day of learners that are trained anew, beside the same ones trained once."""

from opml.base.section import JobSettings
from opml.figures import own_study, style
from opml.figures.axis_labels import lines
from opml.figures.display_names import describe_run
from opml.learning.judge.rolling_origins import by_day
from opml.workflow.jobs import job, read_by_key


class Settings(JobSettings):
    rso: str
    stations: str
    learners: list[str]
    last_days: float
    every_days: float
    epoch: str
    weather: str


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    tables = read_by_key(settings.learners, snakemake.input, "rolling")
    days = {learner: by_day(table) for learner, table in tables.items()}
    note = (
        f"{describe_run(settings.rso, settings.stations)}, {settings.last_days:g} days to learn from at most"
    )
    figure = own_study.rolling(
        days, every_days=settings.every_days, epoch=settings.epoch, note=lines(note, settings.weather)
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
