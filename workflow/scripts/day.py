"""Write the page of a day."""

from opml.base.section import JobSettings
from opml.mornings import outcomes, weather_of_day
from opml.report import day, document
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    hour: float
    date: str


with job(snakemake):
    settings, files, output = Settings(**snakemake.params.settings), snakemake.input, snakemake.output
    found = [outcome for path in files.objects for outcome in outcomes.read(path)]
    weather = weather_of_day.read(files, epoch=settings.epoch, hour=settings.hour, day=settings.date)
    document.write(day.document(found, weather, date=settings.date), output.md, output.tsv, output.html)
    outcomes.write(output.json, day.as_json(found, weather, date=settings.date))
